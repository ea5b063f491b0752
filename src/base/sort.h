/* SPDX-License-Identifier: MIT */
/*
 * Stable radix sort by 64-bit key: the order does not depend on threads or on the platform's qsort.
 */
#ifndef RB_BASE_SORT_H
#define RB_BASE_SORT_H

#include <stddef.h>
#include <stdint.h>

struct rb_sort_item {
	uint64_t key;
	uint64_t value;
};

/*
 * Sorts `items` ascending by key, `scratch` has room for as many. Byte columns that are all alike
 * are skipped; short lists are sorted by insertion.
 */
void rb_sort_by_key(struct rb_sort_item *items, struct rb_sort_item *scratch, size_t count);

#endif
