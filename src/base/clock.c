/* SPDX-License-Identifier: MIT */
/*
 * Both clocks are those of clock_gettime: CLOCK_MONOTONIC for durations, since it neither jumps
 * with the wall clock nor runs backwards, and CLOCK_THREAD_CPUTIME_ID for the work of one thread.
 * The date is UTC with 'Z', so that recordings of two time zones compare as text, and has
 * microseconds, which tell runs apart that were started one after the other under one name.
 */
#include "base/clock.h"

#include <stdio.h>
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
	struct timespec now = {0};
	struct tm parts = {.tm_mday = 1, .tm_year = 70};

	clock_gettime(CLOCK_REALTIME, &now);
	gmtime_r(&now.tv_sec, &parts);
	const size_t size = strftime(out, 32, "%Y-%m-%dT%H:%M:%S", &parts);
	snprintf(out + size, 32 - size, ".%06ldZ", now.tv_nsec / 1000);
}
