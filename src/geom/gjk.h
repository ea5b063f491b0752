/* SPDX-License-Identifier: MIT */
/*
 * How far two cores are apart, from both sides: a distance that two of their points have, and one
 * that a direction proves (Gilbert, Johnson, Keerthi 1988). Goes on until the two agree to rounding
 * or nothing gets better. Pure.
 *
 * What comes out guides an exact search (geom/axes): it says which features can matter, not what
 * the answer is.
 */
#ifndef RB_GEOM_GJK_H
#define RB_GEOM_GJK_H

#include "geom/core.h"

typedef struct {
	bool is_separate; /* proved; else they overlap, or nearly, and `upper` is no bound */
	double upper;     /* m: they are no farther apart */
	double least;     /* m: nor nearer */
	rb_vec3 normal;   /* unit, from a to b */
	int rounds;
} rb_gjk;

/*
 * Cores without radii, no half spaces; their `at` must be near the origin. `scale`: their sizes and
 * distance, m. `small`: 0, or m: of distances below it no digits are asked for, of others two,
 * which round cores come to in a third of the rounds.
 */
rb_gjk rb_gjk_run(const rb_placed *a, const rb_placed *b, double scale, double small);

/*
 * How far `*axis`, unit, proves them apart by its own sum, m, if that is more than `limit`.
 * -INFINITY: nearer, or not seen to be. Begins with the direction in `*axis`, where that is not
 * zero, and leaves the last one tried there, of at most `rounds`. The same cores.
 */
double rb_gjk_beyond(const rb_placed *a, const rb_placed *b, double limit, int rounds,
                     rb_vec3 *axis);

#endif
