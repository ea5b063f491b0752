/* SPDX-License-Identifier: MIT */
/*
 * How two bodies on one piece move relative to each other: by a polynomial as well, the difference
 * of theirs. Gravitation has all bodies on one piece; two moons side by side have large
 * accelerations and a small relative one, of which the bounds are that much closer.
 */
#ifndef RB_LOCATED_RELATIVE_H
#define RB_LOCATED_RELATIVE_H

#include "located/arc.h"

/* Are both on one piece that gravitation has joined, about their centres of mass? */
bool rb_relative_is(const struct rb_located *l, int a, int b);

/* Bounds over the piece of b's acceleration relative to a's, and of its rate: m/s^2, m/s^3. */
void rb_relative_bounds(const struct rb_located *l, int a, int b, double *external, double *jerk);

/*
 * Do the centres keep farther apart than `least` from the piece's beginning to `until`? By bounds.
 */
bool rb_relative_began_far(const struct rb_located *l, int a, int b, double until, double least);

/*
 * ... from `from` to `until`? By the expansion of the distance's square in Chebyshev polynomials,
 * which is exact: of two bodies that turn about each other in contact but for 1e-7 of their size it
 * still says so at once. False: it is not said.
 */
bool rb_relative_is_separated(const struct rb_located *l, int a, int b, double from, double until,
                              double least);

/*
 * A parabola of a body's centre of mass from `from_s` on: its arc, or the nearest to its piece, the
 * acceleration of which is within `off` of this one's (m/s^2) from `age` seconds before on, where
 * the piece began.
 */
struct rb_parabola {
	rb_vec3 position, velocity, acceleration;
	double off, age;
};
struct rb_parabola rb_relative_parabola(const struct rb_located *l, int i, double from_s);

/*
 * Do the centres stay farther apart than `least` (m) for `h` seconds? And one from a plane at rest,
 * through `point` with unit normal `n`, on the side of `n`? False: not known. Without evaluating a
 * polynomial, which is the cost of a pair where many bodies are on pieces.
 */
bool rb_relative_stay_separated(const struct rb_parabola *a, const struct rb_parabola *b, double h,
                                double least);
bool rb_relative_remain_above(const struct rb_parabola *a, rb_vec3 point, rb_vec3 n, double h,
                              double least);

#endif
