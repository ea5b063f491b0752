/* SPDX-License-Identifier: MIT */
/*
 * Where a polynomial of degree at most four falls through zero: for distances of points on
 * parabolas.
 */
#ifndef RB_MATH_QUARTIC_H
#define RB_MATH_QUARTIC_H

/*
 * The first t in (0, most] at which c[0] + c[1] t + ... + c[4] t^4 comes from above to zero or
 * below, to rounding of the coefficients; INFINITY: none. At t = 0 it counts as above, whatever
 * rounding makes of c[0]. `most` is finite. Roots are bracketed by those of the derivative, so none
 * is missed.
 */
double rb_quartic_falls(const double c[5], double max);

#endif
