/* SPDX-License-Identifier: MIT */
/*
 * The status and the error record are public (<rbsim/error.h>); here is what only our sources use.
 */
#ifndef RB_BASE_ERROR_H
#define RB_BASE_ERROR_H

#include <stddef.h>

#include <rbsim/error.h>

/* For our own bugs: says where and aborts, in release too. Not inside inner loops. */
#define RB_ASSERT(cond) ((cond) ? (void)0 : rb_bug(__FILE__, __LINE__, #cond))

/*
 * The same where it would cost too much: in inner loops, or over all of an array. Tried in debug,
 * sanitizer and fuzzer builds, which define RB_CHECKED_BUILD; elsewhere it is only compiled.
 */
#ifdef RB_CHECKED_BUILD
enum { RB_IS_CHECKED_BUILD = 1 };
#define RB_ASSERT_COSTLY(cond) RB_ASSERT(cond)
#else
enum { RB_IS_CHECKED_BUILD = 0 };
#define RB_ASSERT_COSTLY(cond) ((void)sizeof((cond) ? 1 : 0))
#endif

/*
 * Writes "FILE:LINE: ", or without a line "FILE: ", as mistakes begin; of a name that is too long,
 * the end.
 */
const char *rb_error_place(const char *file, int line, char *out, size_t size);

_Noreturn void rb_bug(const char *file, int line, const char *what);

#endif
