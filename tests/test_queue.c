/* SPDX-License-Identifier: MIT */
/* src/located/queue.c: always what a look at all bodies would find */
#include "support.h"

#include "base/memory.h"
#include "located/queue.h"
#include "math/random.h"

enum { MOST = 700 };
static const double never = (double)INFINITY;
static double times[MOST];

static int look_at_all(int count, double *time)
{
	int first = -1;

	*time = never;
	for (int body = 0; body < count; body++) {
		if (times[body] < *time) {
			*time = times[body];
			first = body;
		}
	}
	return first;
}

static struct rb_queue *make(int count)
{
	struct rb_queue *queue;
	struct rb_error err;

	assert_ok(rb_queue_create(&queue, count, &err));
	for (int body = 0; body < count; body++)
		times[body] = never;
	return queue;
}

static void set(struct rb_queue *queue, int body, double time)
{
	times[body] = time;
	rb_queue_set(queue, body, time);
}

static void assert_first(const struct rb_queue *queue, int count)
{
	double time, expected_time;
	const int body = rb_queue_first(queue, &time);
	const int expected = look_at_all(count, &expected_time);

	if (body != expected || !(time == expected_time))
		fail_msg("first is %d at %.17g and not %d at %.17g", body, time, expected,
		         expected_time);
}

/* A pattern gives the next time of a body when the first event was at `now`; u is uniform in [0, 1). */
static double soon(double now, double u)
{
	return now - log(1 - u);
}

/* ties everywhere, also with the present */
static double whole(double now, double u)
{
	return floor(now) + floor(4 * u);
}

/* before what was first, and far beyond */
static double anywhere(double now, double u)
{
	(void)now;
	return u < 0.1 ? never : (u - 0.5) * 1e6;
}

static double any_size(double now, double u)
{
	(void)now;
	return u < 0.5 ? pow(10, 1200 * (u - 0.25)) : -pow(10, 1200 * (u - 0.75));
}

/* nearly all come at the same time, ever again */
static double together(double now, double u)
{
	return u < 0.02 ? now + u : floor(now) + 1;
}

/* most have nothing to wait for, as in a scene at rest */
static double seldom(double now, double u)
{
	return u < 0.8 ? never : now + u;
}

/* the clock itself speeds up and slows down by twelve decades */
static double at_changing_pace(double now, double u)
{
	return now - log(1 - u) * pow(10, 6 * sin(now / 30));
}

static double (*const patterns[])(double now, double u) = {
	soon, whole, anywhere, any_size, together, seldom, at_changing_pace,
};

static void the_first_is_what_a_look_at_all_bodies_finds(void **state)
{
	static const int counts[] = {1, 2, 3, 64, 65, 130, MOST};

	(void)state;
	for (size_t p = 0; p < sizeof patterns / sizeof *patterns; p++) {
		for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
			const int count = counts[c];
			struct rb_queue *queue = make(count);

			for (uint64_t i = 0; i < 15000; i++) {
				double now;
				int body = rb_queue_first(queue, &now);

				/* the first and somebody else in turn; whoever, when there is none */
				if (body < 0 || i % 2 == 1)
					body = (int)(rb_random_unit(p, 1, i) * count);
				if (!isfinite(now))
					now = (double)i / 1000;
				set(queue, body, patterns[p](now, rb_random_unit(p, 2, i)));
				assert_first(queue, count);
			}
			for (int body = 0; body < count; body++)
				assert_true(rb_queue_time(queue, body) == times[body]);
			rb_queue_destroy(queue);
		}
	}
}

static void events_come_by_time_and_then_by_number(void **state)
{
	struct rb_queue *queue = make(MOST);
	double time, last_time = -never;
	int last = -1;

	(void)state;
	/* twice, so that the days are laid out; downwards, so that the history would show */
	for (int round = 0; round < 4; round++) {
		for (int body = MOST - 1; body >= 0; body--)
			set(queue, body, (double)(rb_random_bits(3, 0, (uint64_t)body) % 50));
	}
	for (int i = 0; i < MOST; i++) {
		const int body = rb_queue_first(queue, &time);

		assert_true(time > last_time || (time == last_time && body > last));
		last = body;
		last_time = time;
		set(queue, body, never);
	}
	assert_int_equal(rb_queue_first(queue, &time), -1);
	assert_true(time == never);
	rb_queue_destroy(queue);
}

static void a_queue_without_events_has_no_first(void **state)
{
	double time = 0;
	struct rb_queue *queue = make(0);

	(void)state;
	assert_int_equal(rb_queue_first(queue, &time), -1);
	assert_true(time == never);
	rb_queue_destroy(queue);

	queue = make(3);
	assert_int_equal(rb_queue_first(queue, &time), -1);
	assert_true(rb_queue_time(queue, 2) == never);
	set(queue, 2, never);
	assert_first(queue, 3);
	set(queue, 1, 1e300);
	assert_first(queue, 3);
	set(queue, 1, never);
	assert_first(queue, 3);
	rb_queue_destroy(queue);
	rb_queue_destroy(NULL);
}

static void setting_times_takes_no_memory(void **state)
{
	struct rb_queue *queue = make(MOST);
	const uint64_t taken = rb_memory_counts().taken;

	(void)state;
	for (uint64_t i = 0; i < 50000; i++) {
		double now;
		int body = rb_queue_first(queue, &now);

		if (body < 0 || i % 3 == 0)
			body = (int)(rb_random_unit(4, 1, i) * MOST);
		rb_queue_set(queue, body, soon(isfinite(now) ? now : 0, rb_random_unit(4, 2, i)));
	}
	assert_true(rb_memory_counts().taken == taken);
	rb_queue_destroy(queue);
}

static void every_allocation_may_fail(void **state)
{
	struct rb_queue *queue;
	enum rb_status status = RB_ERR_MEMORY;
	const uint64_t bytes = rb_memory_counts().bytes_now;

	(void)state;
	for (uint64_t k = 1; status != RB_OK; k++) {
		struct rb_error err;

		rb_memory_fail_at(k);
		status = rb_queue_create(&queue, 100, &err);
		rb_memory_fail_at(0);
		assert_true(status == RB_OK || status == RB_ERR_MEMORY);
		assert_true((queue != NULL) == (status == RB_OK));
		if (status != RB_OK)
			assert_true(rb_memory_counts().bytes_now == bytes);
	}
	rb_queue_destroy(queue);
	assert_true(rb_memory_counts().bytes_now == bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_first_is_what_a_look_at_all_bodies_finds),
		cmocka_unit_test(events_come_by_time_and_then_by_number),
		cmocka_unit_test(a_queue_without_events_has_no_first),
		cmocka_unit_test(setting_times_takes_no_memory),
		cmocka_unit_test(every_allocation_may_fail),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
