/* SPDX-License-Identifier: MIT */
/*
 * How deep candidates overlap, pair by pair, by blocks; what they come to stands with the
 * candidates.
 */
#ifndef RB_STEPPED_DEPTH_H
#define RB_STEPPED_DEPTH_H

#include "stepped/candidates.h"

/* A pair that overlaps by more than the tolerance. */
struct rb_deep {
	int a, b;
	double depth; /* m */
};

struct rb_depths {
	double max;           /* m: the largest overlap of all other pairs */
	double resting;       /* m: of pairs that are not live */
	struct rb_deep *deep; /* in the arena, in order of pairs */
	size_t deep_count, deep_capacity;
	bool failed; /* no memory */
};

/*
 * Overlaps of the candidates in the present state; bodies with a mark in `skip` (may be NULL) are
 * left out. Measured are the live ones; with `moved`, those of bodies with a mark there: all others
 * are as they were measured before.
 */
RB_CHECKED enum rb_status rb_depths_find(struct rb_world *world, struct rb_candidates *candidates,
                                         const unsigned char *skip, const unsigned char *moved,
                                         struct rb_depths *found, struct rb_error *err);

#endif
