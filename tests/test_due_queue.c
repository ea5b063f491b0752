/* SPDX-License-Identifier: MIT */
/* src/stepped/due_queue.c: comes out by time, ties by point. */
#include "stepped/due_queue.h"

#include "base/memory.h"
#include "math/random.h"
#include "support.h"

enum { COUNT = 500 };

static void times_come_out_in_order(void **state)
{
	struct rb_due_queue queue = {0};
	struct rb_due last = {-1, 0};
	size_t sum = 0;

	(void)state;
	for (size_t k = 0; k < COUNT; k++) {
		/* one of 50 times: many ties */
		const double t = (double)(rb_random_bits(3, 0, k) % 50);

		assert_int_equal(rb_due_queue_add(&queue, (struct rb_due){t, k}, NULL), RB_OK);
	}
	for (size_t k = 0; k < COUNT; k++) {
		const struct rb_due due = rb_due_queue_next(&queue);

		assert_true(due.t_s > last.t_s || (due.t_s == last.t_s && due.point > last.point));
		sum += due.point;
		last = due;
	}
	assert_int_equal(queue.count, 0);
	assert_int_equal(sum, COUNT * (COUNT - 1) / 2);
	rb_memory_free(queue.row);
}

static void what_is_added_in_between_is_sorted_in(void **state)
{
	struct rb_due_queue queue = {0};

	(void)state;
	for (size_t k = 0; k < 8; k++)
		assert_int_equal(
			rb_due_queue_add(&queue, (struct rb_due){2.0 * (double)k, k}, NULL), RB_OK);
	assert_true(rb_due_queue_next(&queue).t_s == 0);
	assert_true(rb_due_queue_next(&queue).t_s == 2);
	assert_int_equal(rb_due_queue_add(&queue, (struct rb_due){3, 99}, NULL), RB_OK);
	assert_int_equal(rb_due_queue_next(&queue).point, 99);
	assert_true(rb_due_queue_next(&queue).t_s == 4);
	rb_memory_free(queue.row);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(times_come_out_in_order),
		cmocka_unit_test(what_is_added_in_between_is_sorted_in),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
