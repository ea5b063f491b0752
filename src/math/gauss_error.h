/* SPDX-License-Identifier: MIT */
/* How far the polynomial of a Gauss step errs, and how long the next one may be. */
#ifndef RB_MATH_GAUSS_ERROR_H
#define RB_MATH_GAUSS_ERROR_H

#include "math/gauss_piece.h"
#include "math/gauss_problem.h"

/* Of rates, integrated, relative to scale: what is missing beyond the coefficients. */
double rb_gauss_tail(const struct rb_gauss_problem *problem, const double *coefficient);

/* Relative to scale or value: what rounding makes of them. */
double rb_gauss_rounded(const struct rb_gauss_problem *problem, const struct rb_gauss_piece *piece);

/* After a step with that error; longer than it only if that `grows`. */
double rb_gauss_next_length(double h_s, double tolerance, double error, bool grows);

#endif
