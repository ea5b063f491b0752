/* SPDX-License-Identifier: MIT */
/*
 * The verbs `console` and `attach`: a terminal over a recording, over a run of its own or over one
 * that goes on elsewhere.
 */
#ifndef RB_APP_CONSOLE_H
#define RB_APP_CONSOLE_H

#include "app/options.h"

int rb_console_main(const struct rb_options *options);
int rb_attach_main(const struct rb_options *options);

#endif
