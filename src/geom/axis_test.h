/* SPDX-License-Identifier: MIT */
/*
 * The signed gap of two convex cores is the largest that any direction proves: n.(b's nearest) -
 * n.(a's farthest), over all unit n. Apart that is their distance, overlapping the least that would
 * part them, so nothing jumps between. Here is one direction being tried; geom/facets and geom/rims
 * know which ones can be best.
 */
#ifndef RB_GEOM_AXIS_TEST_H
#define RB_GEOM_AXIS_TEST_H

#include "geom/core.h"

typedef struct {
	const rb_placed *a, *b; /* `at` near the origin; no half spaces */
	double noise;           /* m: gaps that differ by no more are alike */
	bool found;
	rb_vec3 normal; /* unit, from a to b: the best so far */
	double gap;     /* m, between the cores */
	double second;  /* m: what the best of the others proves */
} rb_axis;

/*
 * Features farther than `depth` behind the outermost along `normal` (a's) or against it (b's) are
 * left out. `distance`: m, the bodies are no farther apart; a better direction then makes a thinner
 * slab. INFINITY: not known.
 */
typedef struct {
	rb_vec3 normal;
	double depth, distance;
} rb_slab;

static inline double rb_axis_gap(const rb_axis *axis, rb_vec3 n)
{
	return rb_vec3_dot(n, rb_vec3_sub(axis->b->at, axis->a->at)) -
	       rb_placed_height(axis->a, n) - rb_placed_height(axis->b, rb_vec3_neg(n));
}

/*
 * Whoever comes first stays unless it is beaten by more than rounding: so the choice does not
 * flicker.
 */
static inline void rb_axis_try(rb_axis *axis, rb_vec3 n)
{
	const double gap = rb_axis_gap(axis, n);

	if (axis->found && !(gap > axis->gap + axis->noise)) {
		axis->second = fmax(axis->second, gap);
		return;
	}
	axis->second = axis->gap;
	axis->found = true;
	axis->normal = n;
	axis->gap = gap;
}

/* The slab of the best direction so far, where it is thinner: see geom/separation. */
static inline void rb_slab_tighten(rb_slab *slab, const rb_axis *axis)
{
	const double max = fmax(slab->distance, fabs(axis->gap));
	const double depth = max - axis->gap + 8 * axis->noise;

	if (!axis->found || !(depth < slab->depth))
		return;
	slab->normal = axis->normal;
	slab->depth = depth;
}

#endif
