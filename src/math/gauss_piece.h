/* SPDX-License-Identifier: MIT */
/*
 * The polynomial of a step of math/gauss: values, rates and bounds within it. All arrays are the
 * caller's; any thread may read.
 */
#ifndef RB_MATH_GAUSS_PIECE_H
#define RB_MATH_GAUSS_PIECE_H

enum { RB_GAUSS_NODES = 8 };

/*
 * An accepted step: values over [0, length_s] from its own origin in time. All arrays are the
 * caller's: start [n], and coefficient [RB_GAUSS_NODES][n]: Legendre coefficients, on [0, 1], of
 * the rates times length_s.
 */
struct rb_gauss_piece {
	int n;
	double length_s;
	double *start, *coefficient;
	double *rest; /* [n]: rounding error of start, to be added; NULL: none */
};

/*
 * Computes the rounding errors of rb_gauss_value at `t` for `count` components from `first` on: of
 * the start and its rest, the polynomial, and the product h v_0 where the rate is row `rate_row[i]`
 * (otherwise below 0), i = 0 for the first.
 */
void rb_gauss_rests(const struct rb_gauss_piece *piece, int first, int count, const int *rate_row,
                    double t, double *rest);

/* Value and rate of component i at `t` from the piece's origin, 0 <= t <= length_s. */
double rb_gauss_value(const struct rb_gauss_piece *piece, int i, double t);
double rb_gauss_rate(const struct rb_gauss_piece *piece, int i, double t);
/* The same for `count` components from `first` on. */
void rb_gauss_some(const struct rb_gauss_piece *piece, int first, int count, double t,
                   double *value);
void rb_gauss_some_rates(const struct rb_gauss_piece *piece, int first, int count, double t,
                         double *rate);
/* All n at once. */
void rb_gauss_values(const struct rb_gauss_piece *piece, double t, double *value);
/*
 * Contribution of each Legendre coefficient to a value, and to its rate times length_s, at a
 * fraction x of the piece, 0 to 1.
 */
void rb_gauss_basis(double x, double value[RB_GAUSS_NODES], double rate[RB_GAUSS_NODES]);
/* Bound of |rate| of component i over the whole piece: the sum of its |coefficients| / length. */
double rb_gauss_rate_bound(const struct rb_gauss_piece *piece, int i);
/* P_0 .. P_(count - 1) on [0, 1], count >= 2. */
void rb_gauss_polynomials(int count, double x, double *weight);

/* Node k of a step, 0 to 1, and the share of the rates at each node in those at a fraction x. */
double rb_gauss_node(int k);
void rb_gauss_lagrange(double x, double weight[RB_GAUSS_NODES]);

/*
 * Makes a piece of other rates recorded at the nodes of an accepted step: its values are their
 * integrals from the step's beginning. `rate`: [RB_GAUSS_NODES][piece->n]; fills start and
 * coefficients.
 */
void rb_gauss_integrate(struct rb_gauss_piece *piece, double length_s, const double *rate);

#endif
