/* SPDX-License-Identifier: MIT */
/* Input of math/gauss. */
#ifndef RB_MATH_GAUSS_PROBLEM_H
#define RB_MATH_GAUSS_PROBLEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

/*
 * Computes the derivatives of `n` values at `time_s` (from the piece's origin); a status other than
 * RB_OK ends the step.
 */
typedef enum rb_status rb_gauss_rates(void *user, double time_s, const double *value, double *rate,
                                      struct rb_error *err);

/*
 * Computes rates that follow from values alone, at negligible cost (RB_GAUSS_QUICK), such as those
 * of orientations from spins; writes only these into `rate`. Values of rows whose rate is a row are
 * from another moment.
 */
typedef void rb_gauss_quick_rates(void *user, const double *value, double *rate);

/* In rate_row: a row whose rate `quick_rates` computes, too. */
enum { RB_GAUSS_QUICK = -2 };

/*
 * Returns the rounding error of the rates over a step with these coefficients, relative to scale;
 * no smaller error is required of the step. For a step that is not accepted, coefficients may have
 * any values.
 */
typedef double rb_gauss_noise(void *user, const double *coefficient);

/*
 * Guess of a step's rates: at t from its beginning, those of a polynomial at from_s + t.
 * coefficient[RB_GAUSS_NODES][n] is as in a piece of that length; its rows whose rate is a row are
 * not used. NULL: none.
 */
struct rb_gauss_guess {
	const double *coefficient;
	double length_s, from_s;
};

struct rb_gauss_problem {
	int n;
	rb_gauss_rates *rates;
	/*
	 * Called for all nodes before each visit of them, so that the changes of the last visit
	 * propagate through a chain q' = w, w' = f(q) in one visit instead of two. NULL: none.
	 */
	rb_gauss_quick_rates *quick_rates;
	rb_gauss_noise *noise; /* NULL: below the tolerance */
	void *user;
	/*
	 * [n]: the row whose value is the rate of this one, and whose own rate is not a row; below
	 * 0: `rates` computes it. For the former, results of `rates` are not used. NULL: all below
	 * 0.
	 */
	const int *rate_row;
	struct rb_gauss_guess guess;
	const double *scale; /* [n]: sizes to which errors are relative, > 0 */
	double tolerance;    /* relative to scale, per step, >= a few ulp */
	/*
	 * Rounding of rates, relative to scale, 1/s, if it is known and more than an ulp. Visits
	 * end if another one would change rates by less than a part of it.
	 */
	double rate_noise;
	double *scratch; /* [rb_gauss_scratch_size(n)] */
	/*
	 * [rb_gauss_newton_size(n)]: scratch of Newton's method (math/gauss_newton), with which a
	 * step may be longer than visits converge, at the cost of `products`; NULL: not used.
	 */
	double *newton;
	uint64_t *products; /* incremented; NULL: not counted */
	uint64_t *calls;    /* incremented by the calls of rates */
	/*
	 * Called after the rates at node 0 .. RB_GAUSS_NODES - 1, in visits that may be the last;
	 * after those of an accepted step nothing is called before rb_gauss_step returns. May be
	 * NULL.
	 */
	void (*visited)(void *user, int node);
	/*
	 * Rates may jump: checks also between each end of the step and the nearest node, for one
	 * more call.
	 */
	bool jumps;
};

#endif
