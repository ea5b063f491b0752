/* SPDX-License-Identifier: MIT */
/*
 * Pieces of closed mechanisms that pass singular positions, in which joint rows depend on each
 * other that are independent before and after: for instance a four-bar linkage whose bars become
 * collinear.
 *
 * Let u be the distance from the path that the joints allow, and w, of either sign, the distance
 * along it to the singular position: the constraint is u w = 0. Its accelerations,
 * u'' w + 2 u' w' = 0, keep u on the path only if it is there already, and an error of u' left by
 * an iteration enters u'' with the factor 2 w'/w, which is large near w = 0 whatever the step: no
 * step past w = 0 converges, and steps up to it become shorter without end. If positions and
 * velocities are projected first, by the smallest motion in the metric of kinetic energy, u'' is
 * that of the path itself, at all nodes except those so close to w = 0 that rounding dominates:
 * rounding of u w enters u by 1/w, and u'' by 1/w^3. Steps are chosen that have no node there.
 */
#ifndef RB_LOCATED_SINGULAR_H
#define RB_LOCATED_SINGULAR_H

#include "located/rates.h"
#include "math/gauss.h"

/*
 * Calls rb_gauss_step for a cluster's piece from w->origin_s; for a closed mechanism for which that
 * fails, with projected poses. Afterwards w->singular.projects says whether they were projected.
 */
enum rb_status rb_singular_step(struct rb_modes *w, const struct rb_gauss_problem *problem,
                                double least_s, double *try_s);

/*
 * Returns the length of the piece to keep, at most `length_s`, such that it does not end just
 * before a singular position: no step from there has it well between two nodes. `value`: scratch,
 * of the piece's values.
 */
double rb_singular_keep(struct rb_modes *w, double length_s, double *value);

#endif
