/* SPDX-License-Identifier: MIT */
/*
 * The status and the error record are public (<rbsim/error.h>); here is what only our sources use.
 */
#ifndef RB_BASE_ERROR_H
#define RB_BASE_ERROR_H

#include <rbsim/error.h>

/* For our own bugs: says where and aborts, in release too. Not inside inner loops. */
#define RB_ASSERT(cond) ((cond) ? (void)0 : rb_bug(__FILE__, __LINE__, #cond))

_Noreturn void rb_bug(const char *file, int line, const char *what);

#endif
