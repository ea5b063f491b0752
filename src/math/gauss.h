/* SPDX-License-Identifier: MIT */
/*
 * Initial value problems y' = f(t, y), of which rows may be x' = v, v' = f(t, x, v), by
 * Gauss-Legendre collocation with 8 nodes and error control; the solution of a step is a polynomial
 * (dense output), so that events can be located on it to rounding.
 *
 *     y_i = y_0 + h sum_j A_ij f_j                      at the nodes c_i, 0 < c_i < 1
 *     x_i = x_0 + c_i h v_0 + h^2 sum_j (A^2)_ij f_j    if x' = v is a row: only f is iterated
 *     h f(t) = sum_k d_k P_k(t/h)                       Legendre coefficients d_k, on [0, 1]
 *     y(h) = y_0 + d_0                                  x' is the v_i interpolated: of degree 7
 *
 * Order 16 at the end of a step (Butcher, Math. Comp. 18 (1964) 50; Hairer, Lubich, Wanner,
 * Geometric Numerical Integration, II.1.3). Values at the nodes are found to rounding by
 * Gauss-Seidel fixed-point iteration, or by Newton's method if that is stiff. The iteration starts
 * from the extrapolated rates of the previous step, with which two visits of the nodes suffice for
 * smooth motion. The step size follows from the decay of the polynomial's own Legendre
 * coefficients, so that the error *within* the step is below the tolerance too. Rounding errors of
 * the values are carried from step to step, so that they grow like a random walk (Hairer,
 * McLachlan, Razakarivony, BIT 48 (2008) 231).
 *
 * Constants: gauss_tables.h, from 70 digits; limits of iteration in gauss.c.
 */
#ifndef RB_MATH_GAUSS_H
#define RB_MATH_GAUSS_H

#include "math/gauss_piece.h"
#include "math/gauss_problem.h"

/* Number of doubles of scratch for a step. */
size_t rb_gauss_scratch_size(int n);

/*
 * Takes one step from piece->start at time `time_s` (added to the piece's own times in calls of
 * `rates`). Tries the length `*try_s` and halves it until the tolerance is met; fills
 * piece->coefficient and length_s, and sets `*try_s` to the next length to try: at most 4 times
 * this step, and of 8 binary digits, so that times of steps add up exactly. RB_ERR_PHYSICS if no
 * step of at least `least_s` succeeds or something is not finite.
 */
RB_CHECKED enum rb_status rb_gauss_step(const struct rb_gauss_problem *problem, double time_s,
                                        double *try_s, double least_s, struct rb_gauss_piece *piece,
                                        struct rb_error *err);

#endif
