/* SPDX-License-Identifier: MIT */
/*
 * `rbsim check`: validates a scene and prints what a run will do and take. Gives the exit status.
 */
#ifndef RB_APP_CHECK_H
#define RB_APP_CHECK_H

#include "app/options.h"

int rb_check_main(const struct rb_options *options);

#endif
