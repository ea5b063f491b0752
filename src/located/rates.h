/* SPDX-License-Identifier: MIT */
/*
 * The right-hand side of a cluster's piece, as math/gauss asks for it: accelerations by external
 * forces and by the contacts in their modes.
 */
#ifndef RB_LOCATED_RATES_H
#define RB_LOCATED_RATES_H

#include "located/modes.h"

/*
 * Accelerations by all but contacts, w->linear and w->angular, and the largest of them, m/s^2.
 * False: no memory, or l->status.
 */
bool rb_rates_external(struct rb_modes *w, double t, double *max);

/*
 * Is the run to end? Of a thousand contacts one evaluation takes a second, and a piece and its
 * checks take hundreds. True: l->status is RB_ERR_INTERRUPT, and the advance under way ends.
 */
bool rb_rates_are_stopped(struct rb_modes *w);

/* Poses from the values of the piece, w->pose. */
void rb_rates_poses(struct rb_modes *w, const double *value);

/*
 * Poses from the values of the piece; forces of contacts, w->force, and accelerations at `t`.
 * False: as above.
 */
bool rb_rates_evaluate(struct rb_modes *w, double t, const double *value);

/*
 * At the beginning of a piece, after rb_rates_evaluate there: from now on its rates are those of
 * trees of joints (located/articulated), where these have no other accelerations but for rounding:
 * that, 1/s, of w->scale, or nothing, is left in `noise`. False: as above.
 */
bool rb_rates_take_trees(struct rb_modes *w, const double *value, double *noise);

/* rb_gauss_rates of a piece that begins, user being the struct rb_modes. */
rb_gauss_rates *rb_rates_of(const struct rb_modes *w);

/* rb_gauss_quick_rates of a struct rb_modes: of orientations. */
void rb_rates_turning(void *user, const double *value, double *rate);

/*
 * Keeps what acts at a node of the integrator for the ledger: `visited` of a struct
 * rb_gauss_problem.
 */
void rb_rates_enter_node(void *user, int node);

#endif
