/* SPDX-License-Identifier: MIT */
/* `rbsim ctl`: one command to a run that listens, for scripts. Gives the exit status. */
#ifndef RB_APP_CTL_H
#define RB_APP_CTL_H

#include "app/options.h"

int rb_ctl_main(const struct rb_options *options);

#endif
