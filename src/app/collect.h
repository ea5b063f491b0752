/* SPDX-License-Identifier: MIT */
/* `rbsim collect`. Main thread. */
#ifndef RB_APP_COLLECT_H
#define RB_APP_COLLECT_H

#include "app/common.h"

int rb_collect_main(const struct rb_options *options);

#endif
