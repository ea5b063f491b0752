/* SPDX-License-Identifier: MIT */
/* src/stepped/impact_queue.c: comes out by time, ties by point. */
#include "stepped/impact_queue.h"

#include "base/memory.h"
#include "math/random.h"
#include "support.h"

enum { COUNT = 500 };

static void times_come_out_in_order(void **state)
{
	struct rb_impact_queue queue = {0};
	struct rb_queued_impact last = {-1, 0};
	size_t sum = 0;

	(void)state;
	for (size_t k = 0; k < COUNT; k++) {
		/* one of 50 times: many ties */
		const double t = (double)(rb_random_bits(3, 0, k) % 50);

		assert_int_equal(rb_impact_queue_add(&queue, (struct rb_queued_impact){t, k}, NULL),
		                 RB_OK);
	}
	for (size_t k = 0; k < COUNT; k++) {
		const struct rb_queued_impact due = rb_impact_queue_next(&queue);

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
	struct rb_impact_queue queue = {0};

	(void)state;
	for (size_t k = 0; k < 8; k++)
		assert_int_equal(rb_impact_queue_add(&queue,
		                                     (struct rb_queued_impact){2.0 * (double)k, k},
		                                     NULL),
		                 RB_OK);
	assert_true(rb_impact_queue_next(&queue).t_s == 0);
	assert_true(rb_impact_queue_next(&queue).t_s == 2);
	assert_int_equal(rb_impact_queue_add(&queue, (struct rb_queued_impact){3, 99}, NULL),
	                 RB_OK);
	assert_int_equal(rb_impact_queue_next(&queue).point, 99);
	assert_true(rb_impact_queue_next(&queue).t_s == 4);
	rb_memory_free(queue.row);
}

/* What is due at another time by now goes; what is left comes out in order. */
static void what_is_foreseen_anew_is_left_out(void **state)
{
	struct rb_impact_queue queue = {0};
	double due_s[COUNT];
	size_t left = 0;

	(void)state;
	for (size_t round = 0; round < 3; round++)
		for (size_t k = 0; k < COUNT; k++) {
			due_s[k] = (double)(rb_random_bits(3, round, k) % 1000) +
			           1000.0 * (double)round;
			assert_int_equal(rb_impact_queue_add(&queue,
			                                     (struct rb_queued_impact){due_s[k], k},
			                                     NULL),
			                 RB_OK);
		}
	for (size_t k = 0; k < COUNT; k += 5)
		due_s[k] = (double)INFINITY;
	rb_impact_queue_keep(&queue, due_s);
	assert_int_equal(queue.count, COUNT - COUNT / 5);
	for (struct rb_queued_impact last = {-1, 0}; queue.count > 0; left++) {
		const struct rb_queued_impact due = rb_impact_queue_next(&queue);

		assert_true(due.t_s > last.t_s || (due.t_s == last.t_s && due.point > last.point));
		assert_true(due.t_s == due_s[due.point]);
		last = due;
	}
	assert_int_equal(left, COUNT - COUNT / 5);
	rb_impact_queue_keep(&queue, due_s);
	assert_int_equal(queue.count, 0);
	rb_memory_free(queue.row);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(times_come_out_in_order),
		cmocka_unit_test(what_is_added_in_between_is_sorted_in),
		cmocka_unit_test(what_is_foreseen_anew_is_left_out),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
