/* SPDX-License-Identifier: MIT */
/*
 * Newton's method for the nodes of a Gauss step, where the fixed point is not found by visits:
 * stiff rates, whose motion is smooth and whose visits are not. Rows are as in math/gauss; with
 * J = d rates / d values, of rows x whose rate is the row v J_b = d rates / d x in v's column, and
 * J_a all other columns, changes of h times the rates at the nodes are
 *
 *     (1 - h A x J_a - h^2 A^2 x J_b) change = what is left        (A: the Runge-Kutta matrix)
 *
 * which is solved for each eigenvalue of A (Butcher, BIT 16 (1976) 237).
 * J is that of the step's beginning, by differences. Rows that neither change by what is stiff nor
 * change it are left out: their visits are what they were.
 */
#ifndef RB_MATH_GAUSS_NEWTON_H
#define RB_MATH_GAUSS_NEWTON_H

#include "math/gauss_piece.h"
#include "math/gauss_problem.h"

/* The largest `n` for which there is such a solution, and the doubles of room that it needs. */
enum { RB_GAUSS_NEWTON_LIMIT = 64 };
size_t rb_gauss_newton_size(int n);

struct rb_gauss_complex {
	double re, im;
};

struct rb_gauss_newton {
	const struct rb_gauss_problem *problem;
	double *jacobian;         /* [n][n]: of each row's rate by each value */
	double *base, *base_rate; /* [n]: where that is */
	/* factors: for each pair of eigenvalues of A, and for an end of the step */
	struct rb_gauss_complex *lu[5], *solution;
	double *left[RB_GAUSS_NODES]; /* [n] */
	int *row, *pivot[5];          /* rows that are solved for; of the factors */
	int count;                    /* of them */
	int failures;                 /* of attempts, in this step */
	/* the Jacobian of the beginning; nothing is gained; of the last attempt */
	bool is_known, is_out, is_used;
};

/* What math/gauss has of an attempt: value_at fills `value` at a node from `g`. */
struct rb_gauss_nodes {
	const void *attempt;
	void (*value_at)(const void *attempt, int node);
	double time_s, h_s;
	double *value, *rate;
	const double *size;
	double *const *g; /* [1 + RB_GAUSS_NODES][n] */
	struct rb_error *err;
};

/* Divides problem->newton. */
void rb_gauss_newton_begin(struct rb_gauss_newton *newton, const struct rb_gauss_problem *problem);

/*
 * The Jacobian at the beginning, where values and rates are `start` and `first`. Only once for all
 * attempts of a step.
 */
RB_CHECKED enum rb_status rb_gauss_newton_prepare(struct rb_gauss_newton *newton,
                                                  const struct rb_gauss_nodes *nodes,
                                                  const double *start, const double *first);

/*
 * Rates at the nodes, from none on: as math/gauss's own. *sweeps is 0 where they are not found, or
 * nothing is stiff.
 */
RB_CHECKED enum rb_status rb_gauss_newton_converge(struct rb_gauss_newton *newton,
                                                   const struct rb_gauss_nodes *nodes, int *sweeps,
                                                   double *left);

/*
 * left[n], h times what rates at one moment are off by, becomes what values would have to be off by
 * for it: of a stiff row far less.
 */
void rb_gauss_newton_soften(const struct rb_gauss_newton *newton, double *left);

#endif
