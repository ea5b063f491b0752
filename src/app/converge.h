/* SPDX-License-Identifier: MIT */
/*
 * rbsim converge: error against run time of one scene, over methods and a ladder of time steps or
 * tolerances.
 */
#ifndef RB_APP_CONVERGE_H
#define RB_APP_CONVERGE_H

#include "app/options.h"

/* Exit status. */
int rb_converge_main(const struct rb_options *options);

#endif
