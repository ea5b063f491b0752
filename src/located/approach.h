/* SPDX-License-Identifier: MIT */
/*
 * Time of touch of two bodies, at least one of which is convex and no sphere: conservative
 * advancement (Mirtich 1996) along a moving separating direction, so that the steps converge to the
 * root like Newton's. Simulator's thread.
 */
#ifndef RB_LOCATED_APPROACH_H
#define RB_LOCATED_APPROACH_H

#include "located/convex_contact.h"

struct rb_approach {
	/*
	 * INFINITY: none; else not before the time asked for; with `unfinished`, the time at which
	 * the search must continue
	 */
	double touch_s;
	bool unfinished;
	bool touching;     /* they touch at the beginning */
	uint64_t products; /* cost of the search: see RB_LOCATED_PRODUCTS */
};

/*
 * First time in [from, until] at which they touch and approach at a point; the interval is within
 * their pieces.
 */
struct rb_approach rb_approach_find(const struct rb_located *l, int a, int b, double from,
                                    double until);

/* True if they touch at t and approach at a point faster than rounding. */
bool rb_approach_now(const struct rb_located *l, int a, int b, double t);

#endif
