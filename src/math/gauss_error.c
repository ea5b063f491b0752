/* SPDX-License-Identifier: MIT */
#include "math/gauss_error.h"

#include <float.h>
#include <math.h>

enum { NODES = RB_GAUSS_NODES };

/* Of the coefficients of a row, together. */
static const double rounding = DBL_EPSILON / 8;

/* fmax and fmin, which are calls. */
static inline double max_of(double a, double b)
{
	return a > b || isnan(b) ? a : b;
}

static inline double min_of(double a, double b)
{
	return a < b || isnan(b) ? a : b;
}

/*
 * The largest part of the rates that the polynomial does not hold, integrated, relative to scale.
 * The missing coefficients are estimated from those that are there, in pairs (of functions that are
 * even or odd about the middle every other one is zero): the last pair falls on as the earlier ones
 * did, whichever fell less.
 */
double rb_gauss_tail(const struct rb_gauss_problem *problem, const double *coefficient)
{
	const size_t n = (size_t)problem->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		double pair[3];

		for (size_t k = 0; k < 3; k++)
			pair[k] = max_of(fabs(coefficient[(2 * k + 2) * n + i]),
			                 fabs(coefficient[(2 * k + 3) * n + i]));
		if (!(pair[2] > 0))
			continue;
		const double fall = min_of(max_of(pair[2] / pair[1], pair[1] / pair[0]), 1);
		/* the integral of P_8 is (P_9 - P_7)/34 on [0, 1] */
		const double missing = pair[2] * fall / (1 - min_of(fall, 0.75)) / 34;
		worst = max_of(worst, missing / problem->scale[i]);
	}
	return worst;
}

/*
 * What the rounding of coefficients makes, relative to scale or value: in a step so long that
 * nearly all of its motion comes from the acceleration little is left of that at its beginning,
 * where an event may cut it. The next one is not to be longer.
 */
double rb_gauss_rounded(const struct rb_gauss_problem *problem, const struct rb_gauss_piece *piece)
{
	const size_t n = (size_t)problem->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		double sum = 0;

		for (size_t k = 0; k < NODES; k++)
			sum += fabs(piece->coefficient[k * n + i]);
		worst = max_of(worst,
		               rounding * sum / max_of(problem->scale[i], fabs(piece->start[i])));
	}
	return worst;
}

/*
 * What to try next; the eighth root by square roots, which round the same everywhere. Rounded down
 * to 8 binary digits, so that the lengths of steps add up without error.
 */
double rb_gauss_next_length(double h_s, double tolerance, double error, bool grows)
{
	const double max = grows ? 4 : 1;
	double factor = max;
	int exponent;

	if (error > 0)
		factor = fmax(fmin(0.8 * sqrt(sqrt(sqrt(tolerance / error))), max), 0.25);
	const double digits = frexp(h_s * factor, &exponent);
	return ldexp(floor(digits * 0x1p8), exponent - 8);
}
