/* SPDX-License-Identifier: MIT */
/* Error estimates for the polynomial of a Gauss step, and the length of the next step. */
#ifndef RB_MATH_GAUSS_ERROR_H
#define RB_MATH_GAUSS_ERROR_H

#include <math.h>

#include "math/gauss_piece.h"
#include "math/gauss_problem.h"

/* The larger of two errors; NaN if one is: fmax would lose it. */
static inline double rb_gauss_worse(double a, double b)
{
	return a > b || isnan(a) ? a : b;
}

/* Integral of the rates' missing part beyond the coefficients, relative to scale. */
double rb_gauss_tail(const struct rb_gauss_problem *problem, const double *coefficient);

/* Rounding error of the coefficients, relative to scale or value. */
double rb_gauss_rounded(const struct rb_gauss_problem *problem, const struct rb_gauss_piece *piece);

/* Next step length after a step with that error; longer only if `grows`. */
double rb_gauss_next_length(double h_s, double tolerance, double error, bool grows);

#endif
