/* SPDX-License-Identifier: MIT */
/*
 * Roots of a polynomial between the roots of its derivative, recursively down to degree 1: between
 * neighbouring extrema there is at most one sign change, so bisection cannot miss a root and
 * converges to the last bit. Ferrari's closed form is not used: it cancels where coefficients
 * differ by many decades, as those of a fast and a slow contact do, and it does not tell the first
 * root by itself.
 */
#include "math/quartic.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/error.h"

/*
 * HALVINGS only bounds the loop, which ends when no double lies between the bounds: 64 steps if
 * each halved the number of doubles between them; one by arithmetic mean may do much less.
 */
enum { DEGREE = 4, HALVINGS = 1100 };

/* Horner's rule. */
static double value(const double *c, int degree, double t)
{
	double sum = c[degree];

	for (int k = degree - 1; k >= 0; k--)
		sum = sum * t + c[k];
	return sum;
}

/* The first double after the sign change between low and high, of which there is one. */
static double bisect(const double *c, int degree, double low, double high)
{
	RB_ASSERT_COSTLY(low <= high); /* equal: two turning points that rounding makes one */

	const bool rises = value(c, degree, high) > 0;

	for (int round = 0; round < HALVINGS; round++) {
		/*
		 * Geometric mean far from zero: the smallest root may be many decades below `high`.
		 */
		const double middle = low > 0 && high > 4 * low ? sqrt(low) * sqrt(high)
		                                                : low + 0.5 * (high - low);

		if (middle <= low || middle >= high)
			break;
		if ((value(c, degree, middle) > 0) == rises)
			high = middle;
		else
			low = middle;
	}
	return high;
}

/* Roots in (0, most] where the sign changes, ascending; returns how many. */
static int roots(const double *c, int degree, double max, double *root)
{
	double slope[DEGREE], turn[DEGREE + 1];
	int turns = 0, count = 0;

	if (degree == 0)
		return 0;
	for (int k = 1; k <= degree; k++)
		slope[k - 1] = k * c[k];
	turns = roots(slope, degree - 1, max, turn);
	turn[turns++] = max;
	double low = 0;
	for (int k = 0; k < turns; k++) {
		/* just after 0 the first coefficient that is not zero decides */
		bool above = value(c, degree, low) > 0;
		if (low == 0)
			for (int m = degree; m >= 0; m--)
				if (c[m] != 0)
					above = c[m] > 0;
		if (above != (value(c, degree, turn[k]) > 0))
			root[count++] = bisect(c, degree, low, turn[k]);
		RB_ASSERT_COSTLY(count <= degree);
		low = turn[k];
	}
	return count;
}

/* Halvings of the interval by which a polynomial without a root is recognized: most of them do. */
enum { PARTS = 3 };

/*
 * True if Bernstein's coefficients, of which the polynomial is a mean, are above `rounding` in all
 * halves of halves.
 */
static bool is_above(const double b[DEGREE + 1], double rounding, int parts)
{
	double least = HUGE_VAL, low[DEGREE + 1], high[DEGREE + 1];

	if (!(b[0] > rounding && b[DEGREE] > rounding))
		return false;
	for (int k = 0; k <= DEGREE; k++)
		least = fmin(least, b[k]);
	if (least > rounding)
		return true;
	if (parts == 0)
		return false;
	/* de Casteljau */
	memcpy(high, b, sizeof high);
	for (int k = 0; k <= DEGREE; k++) {
		low[k] = high[0];
		for (int m = 0; m < DEGREE - k; m++)
			high[m] = 0.5 * (high[m] + high[m + 1]);
	}
	return is_above(low, rounding, parts - 1) && is_above(high, rounding, parts - 1);
}

/* True if it is above zero up to `max` by more than rounding; false says nothing. */
static bool has_no_root(const double c[DEGREE + 1], double max)
{
	double b[DEGREE + 1], term[DEGREE + 1], power = 1, sum = 0;

	for (int k = 0; k <= DEGREE; k++) {
		term[k] = c[k] * power;
		sum += fabs(term[k]);
		power *= max;
	}
	b[0] = term[0];
	b[1] = b[0] + term[1] / 4;
	b[2] = b[0] + term[1] / 2 + term[2] / 6;
	b[3] = b[0] + 3 * term[1] / 4 + term[2] / 2 + term[3] / 4;
	b[4] = b[0] + term[1] + term[2] + term[3] + term[4];
	return is_above(b, 64 * DBL_EPSILON * sum, PARTS);
}

double rb_quartic_falls(const double c[5], double max)
{
	RB_ASSERT(max < (double)INFINITY);

	if (has_no_root(c, max))
		return (double)INFINITY;

	double root[DEGREE + 1];
	/*
	 * A contact that has just been resolved has a distance of rounding, of either sign: taken
	 * as zero, it counts as touching from above.
	 */
	const double from_above[DEGREE + 1] = {c[0] > 0 ? c[0] : 0, c[1], c[2], c[3], c[4]};
	const int count = roots(from_above, DEGREE, max, root);

	for (int k = 0; k < count; k++) {
		double slope = 0;

		for (int m = DEGREE; m >= 1; m--)
			slope = slope * root[k] + m * c[m];
		if (slope < 0)
			return root[k];
	}
	return (double)INFINITY;
}

/* The exponent of the largest component. */
static int exponent_of(rb_vec3 a)
{
	int exponent;

	frexp(fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))), &exponent);
	return exponent;
}

static rb_vec3 shifted(rb_vec3 a, int exponent)
{
	return (rb_vec3){ldexp(a.x, exponent), ldexp(a.y, exponent), ldexp(a.z, exponent)};
}

double rb_touch_time(rb_vec3 d, rb_vec3 w, double sum)
{
	const int length = exponent_of(d), speed = exponent_of(w);

	d = shifted(d, -length);
	w = shifted(w, -speed);
	sum = ldexp(sum, -length);
	const double b = rb_vec3_dot(d, w), square = rb_vec3_dot(w, w);
	const double offset = rb_vec3_length(rb_vec3_cross(d, w)), reach = sqrt(square) * sum;
	const double discriminant = (reach - offset) * (reach + offset);

	if (!(b < 0) || !(discriminant >= 0))
		return HUGE_VAL;
	const double c = rb_vec3_dot(d, d) - sum * sum;
	return ldexp(c / (sqrt(discriminant) - b), length - speed);
}
