/* SPDX-License-Identifier: MIT */
/*
 * Relative motion of two bodies on one piece: the difference of their polynomials, which is one as
 * well. Gravitation puts all bodies on one piece; two neighbouring moons have large accelerations
 * but a small relative one, whose bounds are correspondingly tighter.
 */
#ifndef RB_LOCATED_RELATIVE_H
#define RB_LOCATED_RELATIVE_H

#include "located/arc.h"

/* True if both are on one piece due to gravitation, with origins at their centres of mass. */
bool rb_relative_is(const struct rb_located *l, int a, int b);

/* Bounds over the piece of b's acceleration relative to a's, m/s^2, and of its rate, m/s^3. */
void rb_relative_bounds(const struct rb_located *l, int a, int b, double *external, double *jerk);

/*
 * True if bounds prove that the centres stay farther apart than `least` from the piece's beginning
 * to `until`.
 */
bool rb_relative_began_far(const struct rb_located *l, int a, int b, double until, double least);

/*
 * The same from `from` to `until`, by the exact expansion of the squared distance in Chebyshev
 * polynomials: it decides at once even for two bodies that orbit each other at a gap of 1e-7 of
 * their size. False: undecided.
 */
bool rb_relative_is_separated(const struct rb_located *l, int a, int b, double from, double until,
                              double least);

/*
 * A parabola of a body's centre of mass from `from_s` on: its arc, or an approximation of its
 * piece. The true acceleration is within `off`, m/s^2, of this one's since the piece began, `age`
 * seconds earlier.
 */
struct rb_parabola {
	rb_vec3 position, velocity, acceleration;
	double off, age;
};
struct rb_parabola rb_relative_parabola(const struct rb_located *l, int i, double from_s);

/*
 * True if the centres stay farther apart than `least`, m, for `h` seconds; and if one stays that
 * far from a plane at rest, through `point` with unit normal `n`, on the side of `n`. False:
 * undecided. Neither evaluates a polynomial, which is the cost of a pair if many bodies are on
 * pieces.
 */
bool rb_relative_stay_separated(const struct rb_parabola *a, const struct rb_parabola *b, double h,
                                double least);
bool rb_relative_remain_above(const struct rb_parabola *a, rb_vec3 point, rb_vec3 n, double h,
                              double least);

#endif
