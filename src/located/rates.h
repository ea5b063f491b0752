/* SPDX-License-Identifier: MIT */
/*
 * The right-hand side of a cluster's piece for math/gauss: accelerations by external forces and by
 * the contacts in their modes.
 */
#ifndef RB_LOCATED_RATES_H
#define RB_LOCATED_RATES_H

#include "located/modes.h"

/*
 * Computes accelerations by everything except contacts, w->linear and w->angular, and the largest
 * of them, m/s^2. False: out of memory, or l->status.
 */
bool rb_rates_external(struct rb_modes *w, double t, double *max);

/*
 * Has the run been interrupted? With a thousand contacts an evaluation takes a second, and a piece
 * with its checks takes hundreds. True: l->status is RB_ERR_INTERRUPT, and the current advance
 * ends.
 */
bool rb_rates_are_stopped(struct rb_modes *w);

/* Computes w->pose from the values of the piece. */
void rb_rates_poses(struct rb_modes *w, const double *value);

/*
 * Computes poses from the values of the piece, then forces of contacts, w->force, and accelerations
 * at `t`. False: as above.
 */
bool rb_rates_evaluate(struct rb_modes *w, double t, const double *value);

/*
 * At the beginning of a piece, after rb_rates_evaluate there: uses trees of joints
 * (located/articulated) for its rates from now on, if their accelerations differ only by rounding,
 * which is stored in `noise`, 1/s relative to w->scale; 0: trees are not used. False: as above.
 */
bool rb_rates_take_trees(struct rb_modes *w, const double *value, double *noise);

/* Returns the rb_gauss_rates of a new piece; `user` is the struct rb_modes. */
rb_gauss_rates *rb_rates_of(const struct rb_modes *w);

/* rb_gauss_quick_rates of a struct rb_modes: rates of orientations. */
void rb_rates_turning(void *user, const double *value, double *rate);

/*
 * Relative error of rates due to rounding of positions: a field is evaluated at rounded coordinates
 * and responds in steps. It is the change along a member's path for a rounding of its position; far
 * from the origin that exceeds the tolerance. For rb_gauss_problem.noise.
 */
double rb_rates_noise(void *user, const double *coefficient);

/* Stores the ledger entries of a node of the integrator: `visited` of a struct rb_gauss_problem. */
void rb_rates_enter_node(void *user, int node);

#endif
