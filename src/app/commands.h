/* SPDX-License-Identifier: MIT */
/*
 * Commands that come with the command line (--commands): lines of a file, some with the simulated
 * time at which they are due, or lines from standard input, read by a thread of their own while the
 * run goes on.
 *
 * Answers go to standard output (with --json to standard error), as the socket would give them.
 */
#ifndef RB_APP_COMMANDS_H
#define RB_APP_COMMANDS_H

#include <stdbool.h>
#include <stdio.h>

#include "control/session.h"

/* ---- a file ---- */

struct rb_commands;

/* What a file of commands is checked against. */
struct rb_commands_check {
	const struct rb_scene *scene; /* its parameters; must live for the call */
	double duration_s;            /* of the run */
	bool attended;                /* somebody else could say play to a run that is paused */
};

/*
 * Reads and checks a file: RB_ERR_INPUT with FILE:LINE for a line that is no command, that a run
 * can't serve, is due only after the end, or would pause a run that nobody could continue. The path
 * is borrowed.
 */
RB_CHECKED enum rb_status rb_commands_read(struct rb_commands **commands, const char *path,
                                           const struct rb_commands_check *check,
                                           struct rb_error *err);
void rb_commands_destroy(struct rb_commands *commands); /* NULL is fine */

/*
 * Executes what is due at a simulated time and was not executed before; answers to `out`. The
 * simulator's thread.
 */
void rb_commands_execute(struct rb_commands *commands, double time_s, struct rb_session *session,
                         FILE *out);

/* ---- standard input ---- */

struct rb_stdin;

/*
 * Starts the thread. At the end of the input `ended` is called, from that thread. Everything is
 * borrowed.
 */
RB_CHECKED enum rb_status rb_stdin_start(struct rb_stdin **input, struct rb_session *session,
                                         FILE *out, void (*ended)(void *user), void *user,
                                         struct rb_error *err);
/* Ends it, in the middle of a line if it must. NULL is fine. */
void rb_stdin_stop(struct rb_stdin *input);

#endif
