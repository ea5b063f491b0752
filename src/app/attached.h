/* SPDX-License-Identifier: MIT */
/*
 * A run that is looked at from outside: its scene, loaded again from what its socket tells, and a
 * run in a process of one's own. Main thread.
 */
#ifndef RB_APP_ATTACHED_H
#define RB_APP_ATTACHED_H

#include <sys/types.h>

#include "app/common.h"
#include "control/client.h"
#include "control/viewer.h"

/*
 * The scene of the run behind `client`, and where its recording is (owned by the caller, NULL: it
 * makes none). Waits while the run starts anew. `loaded` is released with rb_loaded_release in any
 * case.
 */
RB_CHECKED enum rb_status rb_attached_load(struct rb_loaded *loaded, char **recording,
                                           struct rb_client *client, bool trust,
                                           struct rb_error *err);

/* A run in a process of its own. */
struct rb_process {
	pid_t process;     /* 0: none, or it has ended */
	int errors;        /* its standard error; not blocking; -1: none */
	int exit_code;     /* once it has ended; 128 + signal where one ended it */
	char address[108]; /* its socket's name */
};

/*
 * Starts `rbsim run` with this command line but for the verb and what only the console takes.
 * `again`: started anew, with these values of parameters; it may replace its own recording. NULL:
 * for the first time. It goes on when this process ends if the options say so.
 */
RB_CHECKED enum rb_status rb_process_start(struct rb_process *child,
                                           const struct rb_options *options,
                                           const struct rb_viewer_run *again, struct rb_error *err);
/* False once it has ended. */
bool rb_process_lives(struct rb_process *child);
/* Connects as soon as it listens; RB_OK with *client NULL where it ended before. */
RB_CHECKED enum rb_status rb_process_connect(struct rb_process *child, struct rb_client **client,
                                             struct rb_error *err);
/* Asks it to end and waits; it is killed where it does not. Safe on one that has ended. */
void rb_process_end(struct rb_process *child);
void rb_process_release(struct rb_process *child);

#endif
