/* SPDX-License-Identifier: MIT */
/*
 * Newton's method for the nodes of a Gauss step where visits do not converge to the fixed point:
 * stiff rates, with smooth motion but diverging visits. Rows are as in math/gauss. Let
 * J = d rates / d values; J_b has d rates / d x in the column of v, for rows x whose rate is the
 * row v, and J_a all other columns. The changes of h times the rates at the nodes are
 *
 *     (1 - h A x J_a - h^2 A^2 x J_b) change = residual        (A: the Runge-Kutta matrix)
 *
 * which is solved for each eigenvalue of A (Butcher, BIT 16 (1976) 237).
 * J is that of the step's beginning, by differences. Rows that are not coupled with stiff ones are
 * left out: for them visits converge.
 */
#ifndef RB_MATH_GAUSS_NEWTON_H
#define RB_MATH_GAUSS_NEWTON_H

#include "math/gauss_piece.h"
#include "math/gauss_problem.h"

/* The largest `n` for this method, and the number of doubles of scratch. */
enum { RB_GAUSS_NEWTON_LIMIT = 64 };
size_t rb_gauss_newton_size(int n);

struct rb_gauss_complex {
	double re, im;
};

struct rb_gauss_newton {
	const struct rb_gauss_problem *problem;
	double *jacobian;         /* [n][n]: derivative of each row's rate by each value */
	double *base, *base_rate; /* [n]: values and rates where it was computed */
	/* factors: for each pair of eigenvalues of A, and for one end of the step */
	struct rb_gauss_complex *lu[5], *solution;
	double *residual[RB_GAUSS_NODES]; /* [n] */
	int *row, *pivot[5];              /* rows that are solved for; pivots of the factors */
	int count;                        /* of them */
	int failures;                     /* failed attempts in this step */
	/* the Jacobian is that of the beginning; no gain, given up; used in the last attempt */
	bool is_known, is_out, is_used;
};

/* Data of an attempt of math/gauss: value_at fills `value` at a node from `g`. */
struct rb_gauss_nodes {
	const void *attempt;
	void (*value_at)(const void *attempt, int node);
	double time_s, h_s;
	double *value, *rate;
	const double *size;
	double *const *g; /* [1 + RB_GAUSS_NODES][n] */
	struct rb_error *err;
};

/* Lays out the arrays in problem->newton. */
void rb_gauss_newton_begin(struct rb_gauss_newton *newton, const struct rb_gauss_problem *problem);

/*
 * Computes the Jacobian at the beginning, where values and rates are `start` and `first`; once for
 * all attempts of a step.
 */
RB_CHECKED enum rb_status rb_gauss_newton_prepare(struct rb_gauss_newton *newton,
                                                  const struct rb_gauss_nodes *nodes,
                                                  const double *start, const double *first);

/*
 * Finds the rates at the nodes, starting from zero, like math/gauss's own iteration. *sweeps is 0
 * if it does not converge, or nothing is stiff.
 */
RB_CHECKED enum rb_status rb_gauss_newton_converge(struct rb_gauss_newton *newton,
                                                   const struct rb_gauss_nodes *nodes, int *sweeps,
                                                   double *residual);

/*
 * Converts errors of rates times h at one moment, residual[n], to the errors of values that cause
 * them: far smaller ones for stiff rows.
 */
void rb_gauss_newton_soften(const struct rb_gauss_newton *newton, double *residual);

#endif
