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
 * rounding, Gauss-Seidel's way, or by Newton's method where that is stiff; it begins with the
 * rates of the step before, continued, which saves all but two visits of the nodes where motion is
 * smooth. The step size follows from the decay of the polynomial's own Legendre coefficients, so
 * that the error *within* the step is below the tolerance too. What rounding leaves of the values
 * goes on from step to step, so that its error grows as that of a random walk does (Hairer,
 * McLachlan, Razakarivony, BIT 48 (2008) 231).
 *
 * Where constants come from: gauss_tables.h, from 70 digits; limits of iteration in gauss.c.
 */
#ifndef RB_MATH_GAUSS_H
#define RB_MATH_GAUSS_H

#include "math/gauss_piece.h"
#include "math/gauss_problem.h"

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

#endif
