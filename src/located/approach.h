/* SPDX-License-Identifier: MIT */
/*
 * When two bodies touch of which one at least is convex and no sphere: conservative steps
 * (conservative advancement, Mirtich 1996) that follow the direction which proves the gap, so that
 * they end on the root as Newton's do.
 */
#ifndef RB_LOCATED_APPROACH_H
#define RB_LOCATED_APPROACH_H

#include "located/convex_contact.h"

struct rb_approach {
	/*
	 * INFINITY: none; else from the moment asked for on, or, with `again`, where to look again
	 */
	double touch_s;
	bool again;
	bool touching;     /* they touch at the beginning */
	uint64_t products; /* what it has cost: see RB_LOCATED_PRODUCTS */
};

/*
 * The first moment in [from, until] at which they touch and approach at a point, neither of them
 * beyond its piece.
 */
struct rb_approach rb_approach_find(const struct rb_located *l, int a, int b, double from,
                                    double until);

/* Do they touch at this moment and approach at a point, by more than rounding? */
bool rb_approach_now(const struct rb_located *l, int a, int b, double t);

#endif
