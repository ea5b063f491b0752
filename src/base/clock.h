/* SPDX-License-Identifier: MIT */
/* Monotonic time, and the date. */
#ifndef RB_BASE_CLOCK_H
#define RB_BASE_CLOCK_H

#include <stdint.h>

uint64_t rb_clock_now_ns(void); /* wall, monotonic */
uint64_t rb_clock_cpu_ns(void); /* of the calling thread */

/* UTC now as 2026-11-21T04:34:31.250000Z. */
void rb_clock_utc(char out[32]);

#endif
