/* SPDX-License-Identifier: MIT */
/* src/base/arena.c */
#include "support.h"

#include "base/arena.h"
#include "base/memory.h"

static int arena_is_released(void **state)
{
	static uint64_t bytes_before;

	if (!*state) {
		bytes_before = rb_memory_counts().bytes_now;
		*state = &bytes_before;
		return 0;
	}
	return rb_memory_counts().bytes_now == bytes_before ? 0 : 1;
}

static void pieces_are_aligned_and_do_not_overlap(void **state)
{
	struct rb_arena arena = {0};
	unsigned char *piece[200];

	(void)state;
	for (size_t i = 0; i < 200; i++) {
		piece[i] = rb_arena_take(&arena, i * 37, 1);
		assert_non_null(piece[i]);
		assert_int_equal((uintptr_t)piece[i] % 64, 0);
		memset(piece[i], (int)i, i * 37);
	}
	for (size_t i = 0; i < 200; i++)
		for (size_t k = 0; k < i * 37; k++)
			assert_int_equal(piece[i][k], i);
	rb_arena_release(&arena);
}

static void a_piece_costs_its_size_rounded_up_to_lines(void **state)
{
	struct rb_arena arena = {0};

	(void)state;
	for (int round = 0; round < 2; round++) {
		assert_non_null(rb_arena_take(&arena, 1, 1));
		assert_non_null(rb_arena_take(&arena, 64, 1));
		assert_non_null(rb_arena_take(&arena, 13, 5));
		assert_int_equal(arena.high_water, 64 + 64 + 128);
		rb_arena_reset(&arena);
	}
	rb_arena_release(&arena);
}

/* Of large ones, only what is written to takes memory. */
static void a_reset_makes_room_for_a_quarter_more_than_was_used_or_twice_as_much(void **state)
{
	struct rb_arena arena = {0};

	(void)state;
	for (size_t size = 100; size < 1000000; size *= 7) {
		assert_non_null(rb_arena_take(&arena, size, 1));
		assert_non_null(rb_arena_take(&arena, size, 2));
		const size_t most = arena.high_water;
		rb_arena_reset(&arena);
		assert_true(arena.size >= most);
		assert_true(arena.size <= (most < 1 << 17 ? most + most / 4 : 2 * most) + 64);
	}
	rb_arena_release(&arena);
}

static void after_a_reset_the_same_step_allocates_nothing(void **state)
{
	struct rb_arena arena = {0};
	uint64_t taken = 0;

	(void)state;
	for (int step = 0; step < 5; step++) {
		taken = rb_memory_counts().taken;
		for (size_t i = 0; i < 100; i++)
			assert_non_null(rb_arena_take(&arena, i * 100, 8));
		rb_arena_reset(&arena);
		assert_int_equal(arena.used, 0);
		if (step > 0)
			assert_int_equal(rb_memory_counts().taken, taken);
	}
	assert_true(arena.size >= arena.high_water);
	rb_arena_release(&arena);
}

static void going_back_to_a_mark_gives_the_same_place_again(void **state)
{
	struct rb_arena arena = {0};

	(void)state;
	/* once in overflow blocks, once in the joined one */
	for (int round = 0; round < 2; round++) {
		int *kept = rb_arena_take(&arena, 10, sizeof *kept);
		assert_non_null(kept);
		kept[9] = 42;
		const rb_arena_mark mark = rb_arena_here(&arena);
		void *first = rb_arena_take(&arena, 50, 1);
		for (int i = 0; i < 50; i++)
			memset(rb_arena_take(&arena, 4096, 1), 0xee, 4096);
		rb_arena_back(&arena, mark);
		assert_ptr_equal(rb_arena_take(&arena, 50, 1), first);
		assert_int_equal(kept[9], 42);
		rb_arena_reset(&arena);
	}
	rb_arena_release(&arena);
}

static void a_mark_before_everything_empties_the_arena(void **state)
{
	struct rb_arena arena = {0};
	const uint64_t before = rb_memory_counts().bytes_now;

	(void)state;
	const rb_arena_mark mark = rb_arena_here(&arena);
	for (int i = 0; i < 20; i++)
		assert_non_null(rb_arena_take(&arena, 10000, 1));
	rb_arena_back(&arena, mark);
	assert_int_equal(arena.used, 0);
	assert_null(arena.overflow);
	assert_int_equal(rb_memory_counts().bytes_now, before);
	rb_arena_release(&arena);
}

static void memory_that_is_out_leaves_the_arena_usable(void **state)
{
	struct rb_arena arena = {0};

	(void)state;
	int *kept = rb_arena_take(&arena, 1, sizeof *kept);
	assert_non_null(kept);
	*kept = 7;
	assert_false(arena.failed);
	for (uint64_t k = 1; k <= 2; k++) {
		rb_memory_fail_at(k);
		assert_null(rb_arena_take(&arena, 1000000, 1));
		rb_memory_fail_at(0);
	}
	assert_null(rb_arena_take(&arena, SIZE_MAX, 2));
	assert_null(rb_arena_take(&arena, SIZE_MAX - 5, 1));
	assert_int_equal(*kept, 7);
	assert_non_null(rb_arena_take(&arena, 1000000, 1));
	assert_true(arena.failed); /* until it is reset */
	rb_memory_fail_at(1);
	rb_arena_reset(&arena);
	rb_memory_fail_at(0);
	assert_false(arena.failed);
	assert_non_null(rb_arena_take(&arena, 1000000, 1));
	rb_arena_release(&arena);
	rb_arena_release(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pieces_are_aligned_and_do_not_overlap),
		cmocka_unit_test(a_piece_costs_its_size_rounded_up_to_lines),
		cmocka_unit_test(
			a_reset_makes_room_for_a_quarter_more_than_was_used_or_twice_as_much),
		cmocka_unit_test(after_a_reset_the_same_step_allocates_nothing),
		cmocka_unit_test(going_back_to_a_mark_gives_the_same_place_again),
		cmocka_unit_test(a_mark_before_everything_empties_the_arena),
		cmocka_unit_test(memory_that_is_out_leaves_the_arena_usable),
	};
	/* the group's teardown fails when a block is still held */
	return cmocka_run_group_tests(tests, arena_is_released, arena_is_released);
}
