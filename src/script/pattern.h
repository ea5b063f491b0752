/* SPDX-License-Identifier: MIT */
/*
 * Lua's patterns, matched with a count of steps.
 *
 * The matcher of Lua's own library runs in C, where no instruction budget sees it, and a short
 * pattern can keep it busy for years. This one has the same meaning (Lua manual, section 6.4.1) and
 * stops when `steps` is used up. Nothing is allocated; texts are borrowed.
 */
#ifndef RB_SCRIPT_PATTERN_H
#define RB_SCRIPT_PATTERN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "script/overtime.h"

enum { RB_PATTERN_CAPTURES = 32 };

enum { RB_CAPTURE_OPEN = -1, RB_CAPTURE_POSITION = -2 };
struct rb_capture {
	const char *start;
	ptrdiff_t size; /* or RB_CAPTURE_* */
};

struct rb_match {
	const char *subject, *subject_end, *pattern_end; /* set by rb_match_start */
	uint64_t steps;                                  /* left; the caller sets it */
	const char *mistake; /* NULL: none; else why the pattern is wrong, or that the steps are
	                        used up */
	const struct rb_overtime
		*overtime; /* NULL: none; ends the match as if the steps were used up */
	int depth;
	int capture_count;
	struct rb_capture capture[RB_PATTERN_CAPTURES];
};

void rb_match_start(struct rb_match *match, const char *subject, size_t subject_size,
                    const char *pattern, size_t pattern_size, uint64_t steps);

/* Where the match of `pattern` (a leading '^' already taken off) that begins at `at` ends; NULL:
 * none, or a mistake. */
const char *rb_match_at(struct rb_match *match, const char *at, const char *pattern);

/* Whether `pattern` is found in `text`: for those who have no Lua state. A pattern that is wrong is
 * looked for as it is. */
bool rb_pattern_found(const char *text, const char *pattern);

#endif
