/* SPDX-License-Identifier: MIT */
/*
 * What tests share: cmocka with the headers it wants, comparison of doubles, a temporary folder.
 * Included first by every test; header only, used by one thread.
 */
#ifndef RB_TESTS_SUPPORT_H
#define RB_TESTS_SUPPORT_H

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/memory.h"

/* Whoever takes memory gives it back: a process that ends with blocks of ours has failed. Its children, which end where
 * they like, are not asked. */
static pid_t support_process;

__attribute__((constructor)) static void support_begin(void)
{
	support_process = getpid();
}

__attribute__((destructor)) static void support_end(void)
{
	const struct rb_memory_counts counts = rb_memory_counts();

	if (getpid() != support_process || counts.taken == counts.freed)
		return;
	fprintf(stderr, "%lld blocks of memory were not given back\n",
	        (long long)(counts.taken - counts.freed));
	fflush(NULL);
	_exit(1);
}

/* |a - b| <= tol; not-a-number is near nothing. On failure both values are printed to the last digit. */
#define assert_near(a, b, tol) \
	support_assert_near((a), (b), (tol), "'" #a "' and '" #b "'", __FILE__, __LINE__)

static inline void support_assert_near(double a, double b, double tol, const char *what,
                                       const char *file, int line)
{
	if (a == b || fabs(a - b) <= tol)
		return;
	print_error("%s: %.17g and %.17g differ by %.3g, more than %.3g\n", what, a, b, fabs(a - b),
	            tol);
	_fail(file, line);
}

/* Calls a function of ours and expects RB_OK; its `err` is named `err` and is printed when not. */
#define assert_ok(call)                                          \
	do {                                                     \
		if ((call) != RB_OK)                             \
			fail_msg("%s: '%s'", #call, (err).text); \
	} while (0)

/* A fresh folder below $TMPDIR, which tools/run-tests removes with all that is in it. `path` is returned. */
static inline char *support_folder(char path[256])
{
	const char *top = getenv("TMPDIR");

	snprintf(path, 256, "%s/rbsim-test-XXXXXX", top ? top : "/tmp");
	if (!mkdtemp(path))
		fail_msg("cannot make a folder '%s'", path);
	return path;
}

/* How many names are in a folder, those that begin with a dot aside. */
static inline int support_count_files(const char *folder)
{
	DIR *const opened = opendir(folder);
	int count = 0;

	assert_non_null(opened);
	for (const struct dirent *entry; (entry = readdir(opened)) != NULL;)
		count += entry->d_name[0] != '.';
	closedir(opened);
	return count;
}

#endif
