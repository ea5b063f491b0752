/* SPDX-License-Identifier: MIT */
/* src/base/clock.c: monotonic time */
#include "support.h"

#include <time.h>

#include "base/clock.h"

static uint64_t monotonic_ns(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void the_time_never_goes_back_and_is_that_of_the_system(void **state)
{
	(void)state;
	for (int k = 0; k < 1000; k++) {
		const uint64_t before = monotonic_ns(), now = rb_clock_now_ns(),
			       after = monotonic_ns();

		assert_true(before <= now && now <= after);
	}
}

/* Sleeping takes wall time and next to none of the thread's. */
static void a_thread_that_sleeps_takes_no_processor_time(void **state)
{
	const struct timespec nap = {.tv_nsec = 50000000};
	const uint64_t wall = rb_clock_now_ns(), cpu = rb_clock_cpu_ns();

	(void)state;
	nanosleep(&nap, NULL);
	const uint64_t used = rb_clock_cpu_ns() - cpu;
	assert_true(rb_clock_now_ns() - wall >= 50000000);
	assert_true(used < 25000000);
	/* working takes some */
	volatile double sum = 0;
	for (int k = 0; k < 100000; k++)
		sum = sum + k;
	assert_true(rb_clock_cpu_ns() > cpu + used);
}

static void utc_is_a_date_as_iso_8601_has_it_and_now(void **state)
{
	char text[32];
	struct tm tm = {0};
	const time_t before = time(NULL);

	(void)state;
	setenv("TZ", "XYZ-5", 1); /* wherever this machine is */
	tzset();
	rb_clock_utc(text);
	const time_t after = time(NULL);
	assert_int_equal(strlen(text), 27);
	const char *const point = strptime(text, "%Y-%m-%dT%H:%M:%S", &tm);
	assert_true(point && *point == '.');
	assert_int_equal(strspn(point + 1, "0123456789"), 6);
	assert_string_equal(point + 7, "Z");
	const time_t told = timegm(&tm);
	/* the coarse clock of time(2) may lag a tick behind */
	assert_true(told >= before && told <= after + 1);
}

/* By them two runs of one name are told apart. */
static void dates_of_one_second_differ(void **state)
{
	const struct timespec nap = {.tv_nsec = 2000};
	char before[32], text[32];

	(void)state;
	rb_clock_utc(before);
	for (int k = 0; k < 1000; k++) {
		nanosleep(&nap, NULL);
		rb_clock_utc(text);
		assert_string_not_equal(before, text);
		memcpy(before, text, sizeof before);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_time_never_goes_back_and_is_that_of_the_system),
		cmocka_unit_test(a_thread_that_sleeps_takes_no_processor_time),
		cmocka_unit_test(utc_is_a_date_as_iso_8601_has_it_and_now),
		cmocka_unit_test(dates_of_one_second_differ),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
