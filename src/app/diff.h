/* SPDX-License-Identifier: MIT */
/* `rbsim diff`: the first frame and body at which two recordings differ. Gives the exit status. */
#ifndef RB_APP_DIFF_H
#define RB_APP_DIFF_H

#include "app/options.h"

int rb_diff_main(const struct rb_options *options);

#endif
