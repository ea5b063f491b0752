/* SPDX-License-Identifier: MIT */
/*
 * What tests leave out under sanitizers, which are slow: what these can't find more in. Included
 * after support.h; header only, used by one thread.
 */
#ifndef RB_TESTS_SANITIZED_H
#define RB_TESTS_SANITIZED_H

#include "support.h"

/*
 * What something is tried with in a release, under the address and under the thread sanitizer: less
 * where these find in few what they find in many. Numbers are compared in release.
 */
#if defined __SANITIZE_ADDRESS__
#define tried(all, address, thread) (address)
#elif defined __SANITIZE_THREAD__
#define tried(all, address, thread) (thread)
#else
#define tried(all, address, thread) (all)
#endif

/* Whether bits are compared with those of one thread, which races with nobody. */
#define compares_threads tried(true, true, false)

/*
 * Runs all tests of an array; under the thread sanitizer those whose names contain one of the given
 * parts, because the others use one thread, which races with nobody. A part that no name contains
 * fails in every build: a test that is given another name is not lost.
 */
#define run_tests_of_threads(tests, ...)                             \
	run_tests_of_parts((tests), sizeof(tests) / sizeof *(tests), \
	                   (const char *const[]){__VA_ARGS__, NULL})

static inline int run_tests_of_parts(const struct CMUnitTest *tests, size_t count,
                                     const char *const *parts)
{
	struct CMUnitTest chosen[64];
	size_t chosen_count = 0;

	for (; *parts; parts++) {
		bool found = false;

		for (size_t k = 0; k < count; k++) {
			if (!strstr(tests[k].name, *parts))
				continue;
			found = true;
			assert_true(chosen_count < sizeof chosen / sizeof *chosen);
			chosen[chosen_count++] = tests[k];
		}
		if (!found) {
			print_error("no test's name contains '%s'\n", *parts);
			return 1;
		}
	}
#ifdef __SANITIZE_THREAD__
	return _cmocka_run_group_tests("tests", chosen, chosen_count, NULL, NULL);
#else
	return _cmocka_run_group_tests("tests", tests, count, NULL, NULL);
#endif
}

#endif
