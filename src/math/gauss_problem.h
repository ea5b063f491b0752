/* SPDX-License-Identifier: MIT */
/* What math/gauss is asked for. */
#ifndef RB_MATH_GAUSS_PROBLEM_H
#define RB_MATH_GAUSS_PROBLEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

/*
 * Derivatives at `time_s` (from the piece's origin) of `n` values; a status other than RB_OK ends
 * the step.
 */
typedef enum rb_status rb_gauss_rates(void *user, double time_s, const double *value, double *rate,
                                      struct rb_error *err);

/*
 * Rates of rows that follow from values alone, with next to no cost (RB_GAUSS_QUICK), as those of
 * orientations from spins: into `rate`, of which nothing else is written. Values of rows whose rate
 * is a row are of another moment.
 */
typedef void rb_gauss_quick_rates(void *user, const double *value, double *rate);

/* In rate_row: of a row whose rate `quick_rates` says, too. */
enum { RB_GAUSS_QUICK = -2 };

/*
 * What the rates' own rounding is over a step with these coefficients, as a share of scale: a step
 * is not asked for less. Of a step that is not accepted they may be anything.
 */
typedef double rb_gauss_noise(void *user, const double *coefficient);

/*
 * A guess of a step's rates: at t from its beginning those of a polynomial at from_s + t.
 * coefficient[RB_GAUSS_NODES][n] as in a piece of that length; what it says of rows whose rate is a
 * row is not used. NULL: none.
 */
struct rb_gauss_guess {
	const double *coefficient;
	double length_s, from_s;
};

struct rb_gauss_problem {
	int n;
	rb_gauss_rates *rates;
	/*
	 * Called for all nodes before each visit of them, so that what the last one has changed
	 * goes through a chain q' = w, w' = f(q) in one visit instead of two. NULL: none.
	 */
	rb_gauss_quick_rates *quick_rates;
	rb_gauss_noise *noise; /* NULL: below the tolerance */
	void *user;
	/*
	 * [n]: the row whose value is the rate of this one, and whose own rate is no row's value;
	 * below 0: `rates` says. Of the former, what `rates` says is not used. NULL: all below 0.
	 */
	const int *rate_row;
	struct rb_gauss_guess guess;
	const double *scale; /* [n]: sizes that the errors are relative to, > 0 */
	double tolerance;    /* of scale, per step, >= a few ulp */
	/*
	 * 1/s, of scale: rounding of rates, where it is known and more than theirs alone. Visits
	 * end where another one would change rates by less than a part of it.
	 */
	double rate_noise;
	double *scratch; /* [rb_gauss_scratch_size(n)] */
	/*
	 * [rb_gauss_newton_size(n)] (math/gauss_newton), with which a step may be longer than
	 * visits converge in, by so many products; NULL: it may not.
	 */
	double *newton;
	uint64_t *products; /* grows; NULL: not counted */
	uint64_t *calls;    /* grows by the calls of rates */
	/*
	 * Called after the rates at node 0 .. RB_GAUSS_NODES - 1, in visits that may be the last;
	 * after those of an accepted step nothing is called before rb_gauss_step returns. May be
	 * NULL.
	 */
	void (*visited)(void *user, int node);
	/*
	 * Rates may jump: also where that is between an end of the step and the node next to it,
	 * for one more call.
	 */
	bool jumps;
};

#endif
