/* SPDX-License-Identifier: MIT */
/* `rbsim methods`: the methods and what each is good for. Gives the exit status. */
#ifndef RB_APP_METHODS_H
#define RB_APP_METHODS_H

#include "app/options.h"

int rb_methods_main(const struct rb_options *options);

#endif
