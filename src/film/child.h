/* SPDX-License-Identifier: MIT */
/*
 * A program beside ours: bytes down its input, its last words, its end. No shell in between.
 *
 * One thread at a time. The thread that starts a program must live as long: the program dies with
 * it, so that it never outlives ours. It gets a process group of its own, default signals, and no
 * descriptor but the standard three and those it is given. SIGPIPE must be blocked or ignored in
 * ours.
 *
 * No wait is without bound: a program that shows no sign of life for `patience_s` is ended, where
 * `cut` is set after RB_CHILD_CUT_S at most. Signs are bytes taken, files that grow, words, and
 * processor time; the last two alone are believed RB_CHILD_BUSY_TIMES as long.
 */
#ifndef RB_FILM_CHILD_H
#define RB_FILM_CHILD_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include <rbsim/error.h>

/* Encoding what is left, or a palette, may say nothing for minutes. */
enum {
	RB_CHILD_SAID_SIZE = 2048,
	RB_CHILD_FILES_MAX = 2,
	RB_CHILD_BUSY_TIMES = 15,
	RB_CHILD_CUT_S = 20
};

enum rb_child_end {
	RB_CHILD_WELL,   /* exit status 0 */
	RB_CHILD_FAILED, /* `outcome` tells */
	RB_CHILD_HUNG,   /* it was ended by us */
	RB_CHILD_LOST    /* nobody knows: it was not ours to wait for */
};

/* What looked like life when somebody looked last. */
struct rb_child_signs {
	uint64_t results; /* bytes taken, sizes and times of files: never the same again */
	uint64_t said, busy_ns;
};

struct rb_child {
	pid_t pid;                     /* 0: none */
	int in, out;                   /* -1: none */
	int complaints;                /* its standard error; -1: none, or at its end */
	char said[RB_CHILD_SAID_SIZE]; /* the end of what it said there */
	size_t said_size;
	enum rb_child_end end; /* once it has ended */
	int outcome;           /* as waitpid tells it */

	/* set by the owner after the start */
	double patience_s;
	const atomic_bool *cut;        /* borrowed; NULL: never */
	int files[RB_CHILD_FILES_MAX]; /* borrowed; what it makes; -1: none */

	uint64_t taken, heard; /* bytes */
	bool watched;
	struct rb_child_signs signs;
	uint64_t result_ns, sign_ns; /* when they changed last */
};

/* A zeroed one that holds nothing. */
void rb_child_init(struct rb_child *child);

/*
 * `arguments` end with NULL. With a pipe to its input, or one from its output. It inherits the
 * descriptors `kept`, which end with -1, are above the standard three and in rising order; NULL:
 * none. RB_ERR_MISSING.
 */
RB_CHECKED enum rb_status rb_child_start(struct rb_child *child, const char *const *arguments,
                                         bool feeds, bool listens, const int *kept,
                                         struct rb_error *err);
/* False: it takes no more; rb_child_wait tells why. */
bool rb_child_feed(struct rb_child *child, const uint8_t *bytes, size_t size);
/* What has come on its standard error, as much as a pipe holds. */
void rb_child_hear(struct rb_child *child);
/* Closes its input and waits. Later calls tell the same. */
enum rb_child_end rb_child_wait(struct rb_child *child);
/* Ends it, if it still runs. */
void rb_child_stop(struct rb_child *child);

/* The last line with something on it; "it said nothing". */
const char *rb_child_last_words(struct rb_child *child);
/* The last line that holds `text`, NULL: none. `line` has room for what was said. */
const char *rb_child_words(const struct rb_child *child, const char *text,
                           char line[RB_CHILD_SAID_SIZE]);

#endif
