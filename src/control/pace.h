/* SPDX-License-Identifier: MIT */
/*
 * When a frame is to be shown: simulated time against the monotonic clock, and how well that was
 * kept.
 *
 * Values; nothing here waits or looks at a clock. Any thread.
 */
#ifndef RB_CONTROL_PACE_H
#define RB_CONTROL_PACE_H

#include <stdint.h>

/* Simulated time goes on from start_s at start_ns, `speed` seconds a second. */
typedef struct {
	double start_s, speed; /* s; > 0 */
	uint64_t start_ns;
} rb_pace;

rb_pace rb_pace_start(double time_s, double speed, uint64_t now_ns);
/* The simulated time that belongs on the screen now. */
double rb_pace_time(const rb_pace *pace, uint64_t now_ns);
/*
 * When a frame of this time is due; start_ns for all before start_s, UINT64_MAX for what takes
 * centuries.
 */
uint64_t rb_pace_due(const rb_pace *pace, double time_s);

enum { RB_LATENESS_BINS = 2000 };

/* How late frames came; zeroed is a good start. */
struct rb_lateness {
	uint64_t count, skipped; /* frames shown; passed over because a later one was due */
	uint64_t first_ns;       /* when the first one was due */
	double t, l, tt, tl;     /* sums over frames: due time since the first, lateness; s */
	double largest_s;
	uint64_t bin[RB_LATENESS_BINS]; /* of 0.1 ms; the last one holds all that came later */
};

void rb_lateness_add(struct rb_lateness *lateness, uint64_t due_ns, uint64_t shown_ns);
/*
 * By how much lateness grows, s per s: the slope of a straight line through all frames. 0 for less
 * than two.
 */
double rb_lateness_drift(const struct rb_lateness *lateness);
double rb_lateness_mean(const struct rb_lateness *lateness); /* s */
/* What a share of all frames keeps within, s, rounded up to 0.1 ms. */
double rb_lateness_within(const struct rb_lateness *lateness, double share);

#endif
