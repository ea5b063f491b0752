/* SPDX-License-Identifier: MIT */
/* src/base/memory.c */
#include "support.h"

#include <pthread.h>
#include <sys/wait.h>

#include "base/memory.h"

static void blocks_are_zeroed_and_aligned(void **state)
{
	(void)state;
	for (size_t size = 0; size < 300000; size = size * 3 + 1) {
		/* dirty what the system will hand out again */
		unsigned char *block = rb_memory_take(size, 1);
		assert_non_null(block);
		memset(block, 0xff, size);
		rb_memory_free(block);

		block = rb_memory_take(size, 1);
		assert_non_null(block);
		assert_int_equal((uintptr_t)block % 64, 0);
		for (size_t i = 0; i < size; i++)
			assert_int_equal(block[i], 0);
		memset(block, 0xff, size);
		rb_memory_free(block);
	}
}

static void a_product_that_overflows_is_refused(void **state)
{
	(void)state;
	assert_null(rb_memory_take(SIZE_MAX / 2, 3));
	assert_null(rb_memory_take(SIZE_MAX, SIZE_MAX));
	assert_null(rb_memory_take(SIZE_MAX - 10, 1));
}

static void counts_follow_what_is_held(void **state)
{
	const struct rb_memory_counts before = rb_memory_counts();

	(void)state;
	void *small = rb_memory_take(3, 7);
	void *large = rb_memory_take(1000, 1000);
	struct rb_memory_counts now = rb_memory_counts();
	assert_int_equal(now.taken - before.taken, 2);
	assert_int_equal(now.bytes_now - before.bytes_now, 1000021);
	assert_true(now.bytes_peak >= now.bytes_now);
	rb_memory_free(small);
	rb_memory_free(large);
	rb_memory_free(NULL);
	now = rb_memory_counts();
	assert_int_equal(now.freed - before.freed, 2);
	assert_int_equal(now.bytes_now, before.bytes_now);
	assert_true(now.bytes_peak >= before.bytes_now + 1000021);
}

static void growing_keeps_the_old_part_and_zeroes_the_new(void **state)
{
	int *block = rb_memory_grow(NULL, 0, 10, sizeof *block);

	(void)state;
	assert_non_null(block);
	for (int i = 0; i < 10; i++)
		block[i] = i + 1;
	block = rb_memory_grow(block, 10, 1000, sizeof *block);
	assert_non_null(block);
	for (int i = 0; i < 1000; i++)
		assert_int_equal(block[i], i < 10 ? i + 1 : 0);
	rb_memory_free(block);
}

static void a_large_block_grows_as_a_small_one_does(void **state)
{
	const size_t few = 100000, used = 60000, many = 900000;
	int *block = rb_memory_take(few, sizeof *block);
	const struct rb_memory_counts before = rb_memory_counts();

	(void)state;
	assert_non_null(block);
	for (size_t i = 0; i < few; i++)
		block[i] = (int)i + 1;
	rb_memory_fail_at(1);
	assert_null(rb_memory_grow(block, few, many, sizeof *block));
	rb_memory_fail_at(0);
	assert_int_equal(block[few - 1], (int)few);
	block = rb_memory_grow(block, used, many, sizeof *block);
	assert_non_null(block);
	assert_int_equal((uintptr_t)block % 64, 0);
	for (size_t i = 0; i < many; i++)
		assert_int_equal(block[i], i < used ? (int)i + 1 : 0);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.bytes_now - before.bytes_now, (many - few) * sizeof *block);
	assert_int_equal(after.taken - before.taken, 1);
	assert_int_equal(after.freed - before.freed, 1);
	block = rb_memory_grow(block, used, 10, sizeof *block);
	assert_non_null(block);
	assert_int_equal(block[9], 10);
	rb_memory_free(block);
}

/* kB of this process that lie in memory; 0: the system does not tell. */
static long resident_kb(void)
{
	FILE *file = fopen("/proc/self/status", "r");
	char line[256];
	long kb = 0;

	while (file && fgets(line, sizeof line, file))
		if (strncmp(line, "VmRSS:", 6) == 0)
			kb = strtol(line + 6, NULL, 10);
	if (file)
		fclose(file);
	return kb;
}

static void room_to_spare_and_what_is_freed_take_no_memory(void **state)
{
	const size_t size = (size_t)64 << 20, part = (size_t)4 << 20;
	const long before = resident_kb();

	(void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
	skip(); /* they keep what is freed */
#endif
	if (before == 0)
		skip();
	for (int k = 0; k < 4; k++) {
		unsigned char *block = rb_memory_take(size / 2, 1);
		assert_non_null(block);
		memset(block, 1, part);
		block = rb_memory_grow(block, size / 2, size, 1);
		assert_non_null(block);
		assert_true(resident_kb() - before < 2 * (long)(part >> 10));
		rb_memory_free(block);
		assert_true(resident_kb() - before < (long)(part >> 10));
	}
}

static void what_is_yielded_takes_no_memory_and_the_rest_stays(void **state)
{
	const size_t size = (size_t)64 << 20, kept = ((size_t)4 << 20) + 100;
	const long before = resident_kb();
	unsigned char *const block = rb_memory_take(size, 1);
	unsigned char *const small = rb_memory_take(100, 1);

	(void)state;
	assert_non_null(block);
	assert_non_null(small);
	rb_memory_discard(NULL, 0);
	rb_memory_discard(small, 0);
	rb_memory_discard(block, size + 1);
	memset(block, 7, size);
	rb_memory_discard(block, kept);
	for (size_t k = 0; k < kept; k++)
		if (block[k] != 7)
			fail_msg("byte %zu is lost", k);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
	if (before > 0)
		assert_true(resident_kb() - before < 2 * (long)(kept >> 10));
#else
	(void)before;
#endif
	memset(block, 8, size);
	rb_memory_free(block); /* which looks at its fence */
	rb_memory_free(small);
}

static void reserving_doubles_and_leaves_all_as_it_was_when_memory_is_out(void **state)
{
	double *block = NULL;
	size_t capacity = 0;

	(void)state;
	assert_true(rb_memory_reserve(&block, &capacity, 5, sizeof *block));
	assert_true(capacity >= 5);
	block[4] = 2.5;
	const size_t first = capacity;
	assert_true(rb_memory_reserve(&block, &capacity, first, sizeof *block));
	assert_int_equal(capacity, first);
	assert_true(rb_memory_reserve(&block, &capacity, first + 1, sizeof *block));
	assert_int_equal(capacity, 2 * first);
	assert_near(block[4], 2.5, 0);

	double *const old = block;
	rb_memory_fail_at(1);
	assert_false(rb_memory_reserve(&block, &capacity, 1000, sizeof *block));
	rb_memory_fail_at(0);
	assert_false(rb_memory_reserve(&block, &capacity, SIZE_MAX / 4, sizeof *block));
	assert_ptr_equal(block, old);
	assert_int_equal(capacity, 2 * first);
	assert_near(block[4], 2.5, 0);
	rb_memory_free(block);
}

static void the_kth_allocation_fails_and_all_after_it(void **state)
{
	const struct rb_memory_counts before = rb_memory_counts();

	(void)state;
	rb_memory_fail_at(3);
	void *first = rb_memory_take(1, 1);
	void *second = rb_memory_take(1, 1);
	void *third = rb_memory_take(1, 1);
	void *fourth = rb_memory_take(1, 1);
	rb_memory_fail_at(0);
	void *fifth = rb_memory_take(1, 1);
	assert_non_null(first);
	assert_non_null(second);
	assert_null(third);
	assert_null(fourth);
	assert_non_null(fifth);
	rb_memory_free(first);
	rb_memory_free(second);
	rb_memory_free(fifth);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, 3);
	assert_int_equal(after.bytes_now, before.bytes_now);
}

static void a_copied_text_is_a_block_of_its_own(void **state)
{
	char text[] = "ball";
	char *copy = rb_memory_copy_text(text);

	(void)state;
	assert_non_null(copy);
	text[0] = 'f';
	assert_string_equal(copy, "ball");
	rb_memory_free(copy);
}

/* Whether a process that writes one byte behind a block of that size, and then frees it, comes to its end. */
static bool goes_unnoticed(size_t size)
{
	const pid_t child = fork();
	int status = 0;

	if (child == 0) {
		unsigned char *volatile block = rb_memory_take(size, 1);
		if (!freopen("/dev/null", "w", stderr))
			_exit(1);
		block[size] ^= 1;
		rb_memory_free(block);
		_exit(0);
	}
	assert_true(child > 0 && waitpid(child, &status, 0) == child);
	return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static void a_byte_written_behind_a_block_ends_the_process(void **state)
{
	(void)state;
	assert_false(goes_unnoticed(1));
	assert_false(goes_unnoticed(64));
#if !defined( \
	__SANITIZE_ADDRESS__) /* large blocks end before what the system gave, and have no fence there */
	assert_false(goes_unnoticed(1000001));
#endif
}

static void *take_and_free_often(void *argument)
{
	(void)argument;
	for (size_t i = 0; i < 2000; i++) {
		void *block = rb_memory_take(i % 100, 16);
		if (block)
			memset(block, 1, i % 100 * 16);
		rb_memory_free(block);
	}
	return NULL;
}

static void counts_hold_with_several_threads(void **state)
{
	const struct rb_memory_counts before = rb_memory_counts();
	pthread_t threads[4];

	(void)state;
	for (int i = 0; i < 4; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, take_and_free_often, NULL), 0);
	for (int i = 0; i < 4; i++)
		pthread_join(threads[i], NULL);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, 8000);
	assert_int_equal(after.freed - before.freed, 8000);
	assert_int_equal(after.bytes_now, before.bytes_now);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(blocks_are_zeroed_and_aligned),
		cmocka_unit_test(a_product_that_overflows_is_refused),
		cmocka_unit_test(counts_follow_what_is_held),
		cmocka_unit_test(growing_keeps_the_old_part_and_zeroes_the_new),
		cmocka_unit_test(a_large_block_grows_as_a_small_one_does),
		cmocka_unit_test(room_to_spare_and_what_is_freed_take_no_memory),
		cmocka_unit_test(what_is_yielded_takes_no_memory_and_the_rest_stays),
		cmocka_unit_test(reserving_doubles_and_leaves_all_as_it_was_when_memory_is_out),
		cmocka_unit_test(the_kth_allocation_fails_and_all_after_it),
		cmocka_unit_test(a_copied_text_is_a_block_of_its_own),
		cmocka_unit_test(a_byte_written_behind_a_block_ends_the_process),
		cmocka_unit_test(counts_hold_with_several_threads),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
