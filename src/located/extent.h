/* SPDX-License-Identifier: MIT */
/* Extent of a body from its centre of mass, in any orientation. Pure. */
#ifndef RB_LOCATED_EXTENT_H
#define RB_LOCATED_EXTENT_H

#include "located/bounds.h"

/* Largest distances of points of the core, m: in all, along and across the axis of the bounds. */
struct rb_extent_reach {
	double core, along, across;
};

/*
 * Distances of a body's points from its centre of mass, m: of all, and of the core. INFINITY for a
 * plane. Rotation moves only the core: a ball around one of its points is the same after any
 * rotation. `centres`: as `points`, with the centres of the ends of cylinders in place of their
 * rims.
 */
struct rb_extent {
	double ball;
	struct rb_extent_reach points, centres;
};

/* `axis`: a unit vector in object coordinates. */
struct rb_extent rb_extent_of(const struct rb_located *l, int i, rb_vec3 axis);

/* Bound on the acceleration of these points by rotation, m/s^2. */
double rb_extent_bend(const struct rb_extent_reach *reach, const struct rb_bounds *max);

#endif
