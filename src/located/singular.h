/* SPDX-License-Identifier: MIT */
/*
 * Pieces of closed mechanisms past singular positions, at which rows of joints depend on each other
 * that are independent before and after, as of a four-bar whose bars come to lie in one line.
 *
 * Beside the way that the joints leave, let u be the distance from it, and w > 0 or < 0 the way to
 * the singular position: joints ask for u w = 0. Their accelerations, u'' w + 2 u' w' = 0, hold u
 * on the way only where it is there already, and what an iteration has left of u' goes into u'' by
 * 2 w'/w, at a distance that is short whatever the step: no step past w = 0 converges, and steps up
 * to it become shorter without end. Where positions and velocities are put right first, by the
 * smallest motion in the metric of kinetic energy, u'' is that of the way itself, at all nodes but
 * those so near to w = 0 that rounding decides: rounding of u w is u by 1/w, of u'' by 1/w^3. Steps
 * are taken that have no node there.
 */
#ifndef RB_LOCATED_SINGULAR_H
#define RB_LOCATED_SINGULAR_H

#include "located/rates.h"
#include "math/gauss.h"

/*
 * rb_gauss_step of a cluster's piece from w->origin_s, on such poses where a mechanism is closed
 * and it would fail without; afterwards w->singular.projects says whether it is one of these.
 */
enum rb_status rb_singular_step(struct rb_modes *w, const struct rb_gauss_problem *problem,
                                double least_s, double *try_s);

/*
 * Of so much of the piece what to keep, so that it does not end just before such a position: no
 * step from there has it well between two nodes. `value`: scratch, of the piece's values.
 */
double rb_singular_keep(struct rb_modes *w, double length_s, double *value);

#endif
