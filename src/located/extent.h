/* SPDX-License-Identifier: MIT */
/* Extent of a body from its centre of mass, in any orientation. Pure. */
#ifndef RB_LOCATED_EXTENT_H
#define RB_LOCATED_EXTENT_H

#include "located/located.h"

/*
 * Distances of a body's points from its centre of mass, m: of all, of the core, and of the core
 * along and across the axis of the bounds. INFINITY for a plane. Rotation moves only the core: a
 * ball around one of its points is the same after any rotation.
 */
struct rb_extent {
	double ball, core, along, across;
};

/* `axis`: a unit vector in object coordinates. */
struct rb_extent rb_extent_of(const struct rb_located *l, int i, rb_vec3 axis);

#endif
