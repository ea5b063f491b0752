/* SPDX-License-Identifier: MIT */
/*
 * Gives the terminal back where its owner can't any more: a small process beside it, which sees
 * when the owner has ended without saying so (SIGKILL, the out-of-memory killer).
 *
 * Owned by whoever has the terminal; one thread, before it has started others. It stops and goes on
 * with its owner's job and dies with the terminal's session.
 */
#ifndef RB_CONTROL_GUARD_H
#define RB_CONTROL_GUARD_H

#include <stddef.h>
#include <sys/types.h>
#include <termios.h>

struct rb_guard {
	pid_t process; /* 0: there is none, and nothing below holds */
	int tell;      /* a pipe to it */
};

/*
 * What is to be written to standard output, and the modes of standard input, NULL: none. Where
 * there can't be a guard there is none.
 */
void rb_guard_start(struct rb_guard *guard, const char *reset, size_t size,
                    const struct termios *modes);
/* The owner gives the terminal back itself. Safe in a signal's handler. */
void rb_guard_dismiss(const struct rb_guard *guard);
/* The same, and it has ended then. */
void rb_guard_stop(struct rb_guard *guard);

#endif
