/* SPDX-License-Identifier: MIT */
/*
 * Both clocks are those of clock_gettime: CLOCK_MONOTONIC for durations, since it neither jumps
 * with the wall clock nor runs backwards, and CLOCK_THREAD_CPUTIME_ID for the work of one thread.
 * The date is UTC with 'Z', so that recordings of two time zones compare as text.
 */
#include "base/clock.h"

#include <time.h>

static uint64_t now_ns(clockid_t clock)
{
	struct timespec t = {0};

	/* Fails only for clocks that a Linux kernel does not know; these two are everywhere. */
	clock_gettime(clock, &t);
	return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

uint64_t rb_clock_now_ns(void)
{
	return now_ns(CLOCK_MONOTONIC);
}

uint64_t rb_clock_cpu_ns(void)
{
	return now_ns(CLOCK_THREAD_CPUTIME_ID);
}

void rb_clock_utc(char out[32])
{
	const time_t now = time(NULL);
	struct tm parts = {.tm_mday = 1, .tm_year = 70};

	gmtime_r(&now, &parts);
	if (strftime(out, 32, "%Y-%m-%dT%H:%M:%SZ", &parts) == 0)
		out[0] = '\0';
}
