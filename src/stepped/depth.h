/* SPDX-License-Identifier: MIT */
/*
 * Penetration depths of candidate pairs, measured in parallel blocks and kept in `depth` of the
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
	double max;           /* m: largest overlap of all other pairs */
	double resting;       /* m: largest overlap of pairs that are not live */
	struct rb_deep *deep; /* in the arena, in order of pairs */
	size_t deep_count, deep_capacity;
	bool failed; /* no memory */
};

/*
 * Measures overlaps of the candidates in the present state; bodies with a mark in `skip` (may be
 * NULL) are left out. Live pairs are measured; with `moved`, those of bodies with a mark there: all
 * others keep their last measurement.
 */
RB_CHECKED enum rb_status rb_depths_find(struct rb_world *world, struct rb_candidates *candidates,
                                         const unsigned char *skip, const unsigned char *moved,
                                         struct rb_depths *found, struct rb_error *err);

#endif
