/* SPDX-License-Identifier: MIT */
#include "math/gauss_error.h"

#include <float.h>
#include <math.h>

enum { NODES = RB_GAUSS_NODES };

/* Rounding of the sum of a row's coefficients. */
static const double rounding = DBL_EPSILON / 8;

/* Inlined fmax and fmin: a quotient of zeros says nothing of the decay. */
static inline double max_of(double a, double b)
{
	return a > b || isnan(b) ? a : b;
}

static inline double min_of(double a, double b)
{
	return a < b || isnan(b) ? a : b;
}

/*
 * The largest part of the rates that the polynomial misses, integrated, relative to scale. The
 * missing coefficients are extrapolated from the existing ones, in pairs (for functions that are
 * even or odd about the middle every other one is zero): the decay of the last pair continues like
 * the slower of the earlier ones.
 */
double rb_gauss_tail(const struct rb_gauss_problem *problem, const double *coefficient)
{
	const size_t n = (size_t)problem->n;
	double worst = 0;

	for (size_t i = 0; i < n; i++) {
		double pair[3];

		for (size_t k = 0; k < 3; k++)
			pair[k] = rb_gauss_worse(fabs(coefficient[(2 * k + 2) * n + i]),
			                         fabs(coefficient[(2 * k + 3) * n + i]));
		if (pair[2] == 0)
			continue;
		const double fall = min_of(max_of(pair[2] / pair[1], pair[1] / pair[0]), 1);
		/* the integral of P_8 is (P_9 - P_7)/34 on [0, 1] */
		const double missing = pair[2] * fall / (1 - min_of(fall, 0.75)) / 34;
		worst = rb_gauss_worse(worst, missing / problem->scale[i]);
	}
	return worst;
}

/*
 * Rounding error of the coefficients, relative to scale or value: in a step so long that nearly all
 * of its motion comes from the acceleration, values near its beginning, where an event may cut it,
 * are inaccurate. The next step should not be longer.
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
 * Next length to try; the eighth root by square roots, which round the same everywhere. Rounded
 * down to 8 binary digits, so that the lengths of steps add up without error.
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
