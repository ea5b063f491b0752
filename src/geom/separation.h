/* SPDX-License-Identifier: MIT */
/*
 * The normal and signed gap of two convex cores, wherever they are: the best of the directions that
 * geom/facets and geom/rims know. Pure.
 */
#ifndef RB_GEOM_SEPARATION_H
#define RB_GEOM_SEPARATION_H

#include "geom/core.h"

typedef struct {
	rb_vec3 normal; /* unit, from a to b */
	double gap;     /* m, between the cores, without their radii */
	double noise;   /* m: what rounding makes of the gap, 16 ulp of sizes and distance */
	/* m: no face across another direction proves more, to the noise; INFINITY: not known */
	double faces;
} rb_separation;

/* At most one of them a half space; their `at` near the origin. */
rb_separation rb_separation_of(const rb_placed *a, const rb_placed *b);

/* m: the noise of that. */
double rb_separation_noise(const rb_placed *a, const rb_placed *b);

/*
 * A gap, m, that rb_separation_of would find no less than, with room for rounding, if one above
 * `limit` is seen; else
 * -INFINITY, which says nothing. Cheap where `*axis` still tells them apart, which it did when this
 * last did; zero: no idea.
 * `rounds`: how many directions may be tried.
 */
double rb_separation_beyond(const rb_placed *a, const rb_placed *b, double limit, int rounds,
                            rb_vec3 *axis);

#endif
