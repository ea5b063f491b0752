/* SPDX-License-Identifier: MIT */
/* rbsim sweep. Main thread. */
#ifndef RB_APP_SWEEP_H
#define RB_APP_SWEEP_H

#include "app/options.h"

/* Exit status of the program. */
int rb_sweep_main(const struct rb_options *options);

#endif
