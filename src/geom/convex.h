/* SPDX-License-Identifier: MIT */
/*
 * How two convex bodies stand to each other: signed gap, normal, the points that face each other
 * and the features these lie on. Pure functions of coordinates; nothing is allocated and nothing
 * kept.
 *
 * The gap is the largest separation that any direction proves. Apart, that is the distance;
 * overlapping, the least way that would part the cores, less their radii; it is continuous through
 * zero. It is right to some ulp of the bodies' sizes and of the distance of their origins, whatever
 * their place in the world, for aspects up to 10^6; of far thinner bodies that are nearly parallel
 * digits go as the angle between their edges. Two cylinders deep in each other may get a way out
 * that is not the shortest. At most one of the two may be a half space, which is solid however
 * deep.
 */
#ifndef RB_GEOM_CONVEX_H
#define RB_GEOM_CONVEX_H

#include "geom/patch_overlap.h"
#include "geom/separation.h"

typedef struct {
	double gap;     /* m: below 0 they overlap */
	rb_vec3 normal; /* unit, from a to b */
	rb_vec3 on_a,
		on_b; /* m, world: on the surfaces; on_b - on_a = gap normal, up to rounding */
	rb_part a, b; /* the features in touch; only ever of a few kinds, see geom/patch.h */
} rb_convex_touch;

rb_convex_touch rb_convex_gap(const rb_placed *a, const rb_placed *b);

/*
 * Seconds within which two bodies cannot touch (conservative advancement, Mirtich 1996): the gap
 * over the fastest that it can close. With n the normal at the gap, `closing` is -n.(v_b - v_a) of
 * their origins, `bend` a bound on how fast that can grow, m/s2, and `turning` the sum of |n x
 * omega| reach of both while these bound how they turn. INFINITY: never. 0: they touch already. A
 * gap that is not a number gives 0.
 */
double rb_convex_safe_time(double gap, double closing, double turning, double bend);

/*
 * The smallest box along the world's axes around a body with its radius; infinite for a half space.
 */
rb_aabb rb_convex_bounds(const rb_placed *p);

/*
 * A box around all places of a body that goes straight from p->at to `to` and meanwhile turns about
 * p->at, wherever that is, by at most `angle` radians about any axes.
 */
rb_aabb rb_convex_swept_bounds(const rb_placed *p, rb_vec3 to, double angle);

/* Distance of the farthest point of the body from its origin, radius included, m. */
double rb_convex_reach(const rb_core *core);

#endif
