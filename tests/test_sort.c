/* SPDX-License-Identifier: MIT */
/* src/base/sort.c */
#include "support.h"

#include "base/hash.h"
#include "base/sort.h"

enum { MOST = 5000 };
static struct rb_sort_item items[MOST], scratch[MOST], copy[MOST];

/* Keys as `mask` lets them through; values are the places before the sort. */
static void fill(size_t count, uint64_t mask)
{
	for (size_t i = 0; i < count; i++)
		items[i] = (struct rb_sort_item){.key = rb_hash_mix(i + count) & mask, .value = i};
	memcpy(copy, items, count * sizeof *items);
}

/* Ascending, ties in the order they had, and nothing lost: values are places, each must come once. */
static void assert_sorted(size_t count)
{
	static bool seen[MOST];

	memset(seen, 0, sizeof seen);
	for (size_t i = 0; i < count; i++) {
		assert_true(items[i].value < count);
		assert_false(seen[items[i].value]);
		seen[items[i].value] = true;
		assert_true(items[i].key == copy[items[i].value].key);
		if (i == 0)
			continue;
		assert_true(items[i - 1].key <= items[i].key);
		if (items[i - 1].key == items[i].key)
			assert_true(items[i - 1].value < items[i].value);
	}
}

static void any_count_of_any_keys_is_sorted_and_stable(void **state)
{
	static const size_t counts[] = {0, 1, 2, 3, 47, 48, 49, 50, 255, 256, 257, 1000, MOST};
	/* all bytes; few keys, many ties; one byte column in the middle; only the highest; none at all */
	static const uint64_t masks[] = {UINT64_MAX,      7, 0xff0000, 0xff00000000000000u,
	                                 0xff000000ff00u, 0};

	(void)state;
	for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
		for (size_t m = 0; m < sizeof masks / sizeof *masks; m++) {
			fill(counts[c], masks[m]);
			rb_sort_by_key(items, scratch, counts[c]);
			assert_sorted(counts[c]);
		}
	}
}

static void a_sorted_and_a_reversed_list_are_sorted(void **state)
{
	(void)state;
	for (int reversed = 0; reversed < 2; reversed++) {
		for (size_t i = 0; i < MOST; i++)
			items[i] = (struct rb_sort_item){.key = (reversed ? MOST - i : i) * 1000003,
			                                 .value = i};
		memcpy(copy, items, sizeof items);
		rb_sort_by_key(items, scratch, MOST);
		assert_sorted(MOST);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_count_of_any_keys_is_sorted_and_stable),
		cmocka_unit_test(a_sorted_and_a_reversed_list_are_sorted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
