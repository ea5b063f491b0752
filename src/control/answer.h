/* SPDX-License-Identifier: MIT */
/*
 * An answer to a command as text of the protocol: lines that begin with a space, then "ok" or
 * "error TEXT".
 *
 * Owned by the caller, one thread at a time; zeroed is a good start. What memory had no room for is
 * told once by rb_answer_end.
 */
#ifndef RB_CONTROL_ANSWER_H
#define RB_CONTROL_ANSWER_H

#include <stdbool.h>
#include <stddef.h>

#include <rbsim/error.h>

struct rb_answer {
	char *text; /* owned, not terminated */
	size_t size, capacity;
	bool lost; /* memory was out in this answer */
};

/* A line of it, of at most 1000 bytes; what is not printable in it becomes '?'. */
void rb_answer_line(struct rb_answer *answer, const char *format, ...) RB_PRINTF(2, 3);
/* Bytes as they are. */
void rb_answer_put(struct rb_answer *answer, const char *bytes, size_t size);
/* The last line: "ok", or "error" with the text of `err`. */
void rb_answer_end(struct rb_answer *answer, enum rb_status status, const struct rb_error *err);
void rb_answer_release(struct rb_answer *answer);

#endif
