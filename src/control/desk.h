/* SPDX-License-Identifier: MIT */
/*
 * The console's loop: keys in, screen out, until the viewer wishes for something else. Part of
 * rbsim-console.so; one thread, which owns terminal and viewer meanwhile.
 */
#ifndef RB_CONTROL_DESK_H
#define RB_CONTROL_DESK_H

#include "control/viewer.h"

/*
 * `listen` is a descriptor from which lines for the log come (a run's standard error), -1: none; it
 * must not block. `*signal` is the one that asked for an end, 0: none did. The terminal is as it
 * was when this returns. RB_ERR_MISSING without a terminal that will do.
 */
RB_CHECKED enum rb_status rb_desk_run(struct rb_viewer *viewer, int listen, int *signal,
                                      struct rb_error *err);

#endif
