/* SPDX-License-Identifier: MIT */
/*
 * Least-significant-digit radix sort with digits of one byte (Knuth, The Art of Computer
 * Programming 3, 5.2.5, algorithm R): stable, no comparisons, and its time depends on the number of
 * items and of digits that differ, not on their order. qsort is not used: it is not stable, and
 * the order of equal keys would depend on the C library. All histograms come from one pass over the
 * keys.
 */
#include "base/sort.h"

#include <string.h>

/*
 * Bytes of a key, values of a byte. Up to INSERTION_COUNT items the n^2 / 4 moves of an insertion
 * sort are fewer than clearing and summing the 8 x 256 counters.
 */
enum { COLUMNS = 8, BUCKETS = 256, INSERTION_COUNT = 48 };

/* Stable, because equal keys are not exchanged. */
static void sort_by_insertion(struct rb_sort_item *items, size_t count)
{
	for (size_t i = 1; i < count; i++) {
		const struct rb_sort_item item = items[i];
		size_t at = i;
		for (; at > 0 && items[at - 1].key > item.key; at--)
			items[at] = items[at - 1];
		items[at] = item;
	}
}

void rb_sort_by_key(struct rb_sort_item *items, struct rb_sort_item *scratch, size_t count)
{
	if (count <= INSERTION_COUNT) {
		sort_by_insertion(items, count);
		return;
	}

	/* how often each byte occurs in each column: one reading for all passes */
	size_t occurs[COLUMNS][BUCKETS] = {{0}};
	for (size_t i = 0; i < count; i++)
		for (int column = 0; column < COLUMNS; column++)
			occurs[column][items[i].key >> 8 * column & 0xff]++;

	/* lowest column first; each pass is stable, so the last one leaves all in order */
	struct rb_sort_item *from = items, *to = scratch;
	for (int column = 0; column < COLUMNS; column++) {
		size_t *at = occurs[column];
		if (at[items[0].key >> 8 * column & 0xff] == count)
			continue;
		size_t start = 0;
		for (int bucket = 0; bucket < BUCKETS; bucket++) {
			const size_t size = at[bucket];
			at[bucket] = start;
			start += size;
		}
		for (size_t i = 0; i < count; i++)
			to[at[from[i].key >> 8 * column & 0xff]++] = from[i];
		struct rb_sort_item *const swap = from;
		from = to;
		to = swap;
	}
	if (from != items)
		memcpy(items, from, count * sizeof *items);
}
