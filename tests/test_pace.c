/* SPDX-License-Identifier: MIT */
/* src/control/pace.c: when frames are due, and how late they were. */
#include "control/pace.h"

#include "support.h"

static const uint64_t second = 1000000000;

static void frames_are_due_in_their_time(void **state)
{
	const rb_pace pace = rb_pace_start(2, 0.5, 10 * second);

	(void)state;
	assert_true(rb_pace_due(&pace, 2) == 10 * second);
	assert_true(rb_pace_due(&pace, 3) == 12 * second);
	assert_true(rb_pace_due(&pace, 1) == 10 * second);
	assert_near(rb_pace_time(&pace, 14 * second), 4, 1e-12);
	assert_near(rb_pace_time(&pace, 9 * second), 2, 0);
}

static void what_takes_centuries_is_never_due(void **state)
{
	const rb_pace slow = rb_pace_start(0, 1e-12, second), fast = rb_pace_start(0, 1e12, second);

	(void)state;
	assert_true(rb_pace_due(&slow, 1) == UINT64_MAX);
	assert_true(rb_pace_due(&slow, (double)INFINITY) == UINT64_MAX);
	assert_true(rb_pace_due(&fast, 1) == second + 1);
	assert_true(rb_pace_due(&fast, (double)NAN) == second);
}

/* The moment that is told is the first at which the frame's time has come. */
static void moments_and_times_agree(void **state)
{
	(void)state;
	for (int speed = 1; speed < 50; speed++) {
		const rb_pace pace = rb_pace_start(0.1 * speed, 0.37 * speed,
		                                   987654321 * second / 3);
		for (int frame = 1; frame < 200; frame++) {
			const double time_s = 0.1 * speed + frame / 60.0;
			const uint64_t due = rb_pace_due(&pace, time_s);
			assert_near(rb_pace_time(&pace, due), time_s, 1e-8 * speed);
		}
	}
}

static void lateness_is_told_as_it_was(void **state)
{
	struct rb_lateness lateness = {0};

	(void)state;
	assert_near(rb_lateness_drift(&lateness), 0, 0);
	assert_near(rb_lateness_within(&lateness, 0.99), 0, 0);
	/* one ms late each, but one in fifty that is 20 ms late */
	for (uint64_t i = 0; i < 1000; i++)
		rb_lateness_add(&lateness, i * second / 60,
		                i * second / 60 + (i % 50 == 25 ? 20000000 : 1000000));
	assert_near(rb_lateness_mean(&lateness), 0.00138, 1e-9);
	assert_near(rb_lateness_within(&lateness, 0.5), 0.0011, 1e-9);
	assert_near(rb_lateness_within(&lateness, 0.97), 0.0011, 1e-9);
	assert_near(rb_lateness_within(&lateness, 0.99), 0.0201, 1e-9);
	assert_near(rb_lateness_drift(&lateness), 0, 1e-5);
}

static void a_clock_that_runs_slow_drifts(void **state)
{
	struct rb_lateness lateness = {0};

	(void)state;
	for (uint64_t i = 0; i < 600; i++)
		rb_lateness_add(&lateness, i * second / 60, i * second / 60 + i * 50000);
	/* 50 us in each sixtieth of a second */
	assert_near(rb_lateness_drift(&lateness), 0.003, 1e-7);
	assert_near(rb_lateness_within(&lateness, 1), 0.03, 1e-3);
	/* what is early is in time */
	rb_lateness_add(&lateness, 20 * second, 19 * second);
	assert_near(lateness.largest_s, 599 * 50e-6, 1e-12);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_are_due_in_their_time),
		cmocka_unit_test(what_takes_centuries_is_never_due),
		cmocka_unit_test(moments_and_times_agree),
		cmocka_unit_test(lateness_is_told_as_it_was),
		cmocka_unit_test(a_clock_that_runs_slow_drifts),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
