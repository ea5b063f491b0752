/* SPDX-License-Identifier: MIT */
#include "math/quartic.h"

#include <math.h>
#include <stdbool.h>

enum { DEGREE = 4, HALVINGS = 1100 };

static double value(const double *c, int degree, double t)
{
	double sum = c[degree];

	for (int k = degree - 1; k >= 0; k--)
		sum = sum * t + c[k];
	return sum;
}

/* The sign changes once between low and high: where, to the last bit. */
static double bisect(const double *c, int degree, double low, double high)
{
	const bool rises = value(c, degree, high) > 0;

	for (int round = 0; round < HALVINGS; round++) {
		/*
		 * far from zero by ratio, since the smallest root may be many decades below `high`
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
		low = turn[k];
	}
	return count;
}

double rb_quartic_falls(const double c[5], double max)
{
	double root[DEGREE + 1];
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
