/* SPDX-License-Identifier: MIT */
/* `rbsim run`: load, simulate, record, report. Gives the exit status. */
#ifndef RB_APP_RUN_H
#define RB_APP_RUN_H

#include "app/options.h"

int rb_run_main(const struct rb_options *options);

/* `rbsim SCENE.lua --help`: the usage, then the scene's parameters. Gives the exit status. */
int rb_run_help(const struct rb_options *options);

#endif
