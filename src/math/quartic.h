/* SPDX-License-Identifier: MIT */
/*
 * Where a polynomial of degree at most four falls through zero: for distances of points on
 * parabolas.
 */
#ifndef RB_MATH_QUARTIC_H
#define RB_MATH_QUARTIC_H

#include <stdbool.h>

#include "math/vec3.h"

/*
 * The first t in (0, most] at which c[0] + c[1] t + ... + c[4] t^4 comes from above to zero or
 * below, to rounding of the coefficients; INFINITY: none. At t = 0 it counts as above, whatever
 * rounding makes of c[0]. `most` is finite. Roots are bracketed by those of the derivative, so none
 * is missed.
 */
double rb_quartic_falls(const double c[5], double max);

/* Whether differences of squares as large as this one keep their digits. */
static inline bool rb_squares_hold(double square)
{
	return square > 0x1p-900 && square < 0x1p1000;
}

/*
 * The time at which |d + w t| falls to `sum`, which |d| exceeds, wherever d and w lie in the range
 * of doubles: for what leaves it when it is squared twice. INFINITY: never.
 */
double rb_touch_time(rb_vec3 d, rb_vec3 w, double sum);

#endif
