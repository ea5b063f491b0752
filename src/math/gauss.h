/* SPDX-License-Identifier: MIT */
/*
 * Initial value problems y' = f(t, y), of which rows may be x' = v, v' = f(t, x, v), by
 * Gauss-Legendre collocation with 8 nodes and error control; the solution of a step is a polynomial
 * (dense output), so that events can be located on it to rounding.
 *
 *     y_i = y_0 + h sum_j A_ij f_j                      at the nodes c_i, 0 < c_i < 1
 *     x_i = x_0 + c_i h v_0 + h^2 sum_j (A^2)_ij f_j    where x' = v is a row: f alone is iterated
 *     h f(t) = sum_k d_k P_k(t/h)                       Legendre coefficients d_k, on [0, 1]
 *     y(h) = y_0 + d_0                                  x' is the v_i interpolated: of degree 7
 *
 * Order 16 at the end of a step (Butcher, Math. Comp. 18 (1964) 50; Hairer, Lubich, Wanner,
 * Geometric Numerical Integration, II.1.3). The nodes are found by fixed-point iteration to
 * rounding, Gauss-Seidel's way; it begins with the rates of the step before, continued, which saves
 * all but two visits of the nodes where motion is smooth. The step size follows from the decay of
 * the polynomial's own Legendre coefficients, so that the error *within* the step is below the
 * tolerance too. What rounding leaves of the values goes on from step to step, so that its error
 * grows as that of a random walk does (Hairer, McLachlan, Razakarivony, BIT 48 (2008) 231).
 *
 * Where constants come from: gauss_tables.h, from 70 digits; limits of iteration in gauss.c.
 */
#ifndef RB_MATH_GAUSS_H
#define RB_MATH_GAUSS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rbsim/error.h>

#include "math/gauss_piece.h"

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
	uint64_t *calls; /* grows by the calls of rates */
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

/* Doubles of scratch that a step needs. */
size_t rb_gauss_scratch_size(int n);

/*
 * One step from piece->start at time `time_s` (added to the piece's own times in calls of `rates`),
 * trying length `*try_s` and halving it until the tolerance is met; fills piece->coefficient and
 * length_s and leaves in `*try_s` what to try next: not longer than 4 times this step, and of 8
 * binary digits, so that times of steps add up exactly. RB_ERR_PHYSICS when no step of at least
 * `least_s` will do or something is not finite.
 */
RB_CHECKED enum rb_status rb_gauss_step(const struct rb_gauss_problem *problem, double time_s,
                                        double *try_s, double least_s, struct rb_gauss_piece *piece,
                                        struct rb_error *err);

/*
 * A piece of what else was seen at the nodes of an accepted step: its values are integrals from the
 * step's beginning on. `rate`: [RB_GAUSS_NODES][piece->n]; start and coefficients of the piece are
 * filled.
 */
void rb_gauss_integrate(struct rb_gauss_piece *piece, double length_s, const double *rate);

#endif
