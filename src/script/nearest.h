/* SPDX-License-Identifier: MIT */
/* The nearest of many names to a word that is none of them: offer all, then ask. Values only,
 * nothing is owned. */
#ifndef RB_SCRIPT_NEAREST_H
#define RB_SCRIPT_NEAREST_H

#include <stddef.h>

struct rb_nearest {
	const char *word; /* borrowed */
	char best[64];
	int distance;
};

struct rb_nearest rb_nearest_to(const char *word);
void rb_nearest_offer(struct rb_nearest *nearest, const char *candidate, size_t size);

/* " (did you mean 'x'?)", or "" where nothing is near. Returns `out`. */
const char *rb_nearest_hint(const struct rb_nearest *nearest, char out[96]);

#endif
