/* SPDX-License-Identifier: MIT */
/*
 * Status codes and the error record.
 *
 * Every function that can fail for the user's or the world's sake returns `enum rb_status` and
 * fills a `struct rb_error` that the caller owns; there is no error state anywhere else. A function
 * that fails leaves its outputs zeroed and releasable. `err` may be NULL everywhere.
 */
#ifndef RBSIM_ERROR_H
#define RBSIM_ERROR_H

#ifdef __cplusplus
extern "C" {
#endif

enum rb_status {
	RB_OK = 0,
	RB_ERR_EXPECT,    /* an expectation failed, or two recordings differ: exit 1 */
	RB_ERR_USAGE,     /* the command line is wrong: 64 */
	RB_ERR_SCENE,     /* the scene is wrong, at load or in a callback: 65 */
	RB_ERR_INPUT,     /* an input is missing or not what it claims to be: 66 */
	RB_ERR_MISSING,   /* a program or library that this run needs is absent or failed: 69 */
	RB_ERR_BUG,       /* ours: 70 */
	RB_ERR_MEMORY,    /* 71 */
	RB_ERR_CREATE,    /* an output can't be created: 73 */
	RB_ERR_IO,        /* a write failed in mid-run: 74 */
	RB_ERR_AGAIN,     /* interrupted after a checkpoint: 75 */
	RB_ERR_PHYSICS,   /* the simulation itself failed: 76 */
	RB_ERR_INTERRUPT, /* SIGINT without a checkpoint: 130 */
	RB_ERR_TERMINATE, /* SIGTERM without a checkpoint: 143 */
	RB_STATUS_COUNT
};

enum { RB_ERROR_TEXT_SIZE = 240 };

struct rb_error {
	enum rb_status status;         /* never RB_OK where a function has failed */
	char text[RB_ERROR_TEXT_SIZE]; /* for the user; cut, never overrun */
	const char *file;              /* where in our sources, for a bug report */
	int line;
};

/* Exit status of the program for a status (`rbsim.1`, EXIT STATUS). */
int rb_status_exit_code(enum rb_status status);

/* Short English name of a status, static storage. */
const char *rb_status_name(enum rb_status status);

#if defined(__GNUC__)
#define RB_PRINTF(format_at, first_at) __attribute__((format(printf, format_at, first_at)))
#define RB_CHECKED __attribute__((warn_unused_result))
#else
#define RB_PRINTF(format_at, first_at)
#define RB_CHECKED
#endif

/* Fills `err` (if not NULL) and returns `status`; use it through RB_FAIL. */
enum rb_status rb_error_set(struct rb_error *err, enum rb_status status, const char *file, int line,
                            const char *format, ...) RB_PRINTF(5, 6);

/* What failed first, lower case, no full stop, subject in single quotes, then the value seen. */
#define RB_FAIL(err, status, ...) rb_error_set((err), (status), __FILE__, __LINE__, __VA_ARGS__)

#ifdef __cplusplus
}
#endif
#endif
