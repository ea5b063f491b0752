/* SPDX-License-Identifier: MIT */
/* The verb `repair`: the recording of a run that was killed becomes a plain file again. */
#ifndef RB_APP_REPAIR_H
#define RB_APP_REPAIR_H

#include "app/options.h"

int rb_repair_main(const struct rb_options *options);

#endif
