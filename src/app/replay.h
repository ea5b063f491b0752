/* SPDX-License-Identifier: MIT */
/*
 * The verb `replay`: a recorded run once more, from what its recording holds, compared frame by
 * frame.
 */
#ifndef RB_APP_REPLAY_H
#define RB_APP_REPLAY_H

#include "app/options.h"

int rb_replay_main(const struct rb_options *options);

#endif
