/* SPDX-License-Identifier: MIT */
/*
 * Energy ledger: entries for a step that is kept.
 *
 * All impulses of a step act together, so each does its work at the mean of the velocities before
 * and after them, exactly; the work of gravity along the actual displacement differs from that by
 * the error of the step. Contacts, impacts and drag dissipate no more than bodies have lost, where
 * that is known: without springs and fields. Solutions for forces on resting bodies leave rounding
 * errors in proportion to these forces.
 */
#ifndef RB_STEPPED_STEP_LEDGER_H
#define RB_STEPPED_STEP_LEDGER_H

#include "stepped/tally.h"

/*
 * Entries of a cohort's step, while its points, impacts and rebounds are valid and after they were
 * recorded; sleeping bodies belong to the cohort of all. `before`: the state at its beginning,
 * driven bodies with the velocities of the step. Bodies with a mark in `skip` (or NULL) are left
 * out.
 */
struct rb_entries rb_step_ledger_enter(struct rb_world *world, const struct rb_cohort *cohort,
                                       const struct rb_state *before, double start_s, double h_s,
                                       const unsigned char *skip);

#endif
