/* SPDX-License-Identifier: MIT */
/* `rbsim info`: what is in a recording and how its run went. Gives the exit status. */
#ifndef RB_APP_INFO_H
#define RB_APP_INFO_H

#include "app/options.h"

int rb_info_main(const struct rb_options *options);

#endif
