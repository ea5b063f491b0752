/* SPDX-License-Identifier: MIT */
/*
 * All points of a touch of two convex bodies: the corners of what their surfaces share, seen along
 * the normal. Pure.
 *
 * Points come in an order that follows from the features, each with a key that says which features
 * meet there; both stay while the bodies move less than the band. Mirrored bodies have mirrored
 * points.
 */
#ifndef RB_GEOM_MANIFOLD_H
#define RB_GEOM_MANIFOLD_H

#include "geom/convex.h"
#include "geom/separation.h"

enum { RB_MANIFOLD_MAX = 16 };

typedef struct {
	rb_vec3 on_a,
		/* m, world: on the surfaces, over each other along the normal up to the band */
		on_b;
	double gap;   /* m, along the normal */
	uint64_t key; /* features: a's in the upper half, b's in the lower */
} rb_manifold_point;

typedef struct {
	rb_vec3 normal; /* unit, from a to b */
	double gap;     /* m: the bodies' */
	double faces;   /* m: as of their separation, to rounding */
	int count;      /* at least 1, but for a gap beyond what was asked for */
	rb_manifold_point point[RB_MANIFOLD_MAX];
} rb_manifold;

/*
 * Points whose gap along the normal exceeds the smallest by no more than `band`, m. Of more than
 * RB_MANIFOLD_MAX, those farthest out in as many directions.
 */
void rb_manifold_of(rb_manifold *manifold, const rb_placed *a, const rb_placed *b, double band);

/*
 * The same along another direction that proves their gap, unit, from a to b: none where what is
 * outermost of both along it does not meet.
 */
void rb_manifold_along(rb_manifold *manifold, const rb_placed *a, const rb_placed *b,
                       rb_vec3 normal, double band);

/*
 * For wide bands. Corners of what lies within a band need not be lowest: a disc that tilts, or
 * lines that cross at a small angle, come lower between them. Where they do by more than `fine`, m,
 * their nearest points are there too. Where the bodies are farther apart than `max`, m, no points
 * are looked for: there are none then.
 */
void rb_manifold_with_nearest(rb_manifold *manifold, const rb_placed *a, const rb_placed *b,
                              double band, double fine, double max);

/* The same from what rb_separation_of has found of both, as seen from a's origin. */
void rb_manifold_from(rb_manifold *manifold, const rb_placed *a, const rb_placed *b,
                      const rb_separation *separation, double band, double fine);

#endif
