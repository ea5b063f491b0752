/* SPDX-License-Identifier: MIT */
/*
 * Entries of the ledger for a step that is kept.
 *
 * All impulses of a step act together, so each does its work at the mean of the velocities before
 * and after them, exactly; what gravity does on the way that bodies have gone differs from that by
 * the error of the step. Contacts, impacts and drag have taken no more than bodies have lost, where
 * that is known: without springs and fields. What solves for forces that hold bodies still leaves
 * rounding, which is of what holds them.
 */
#ifndef RB_STEPPED_STEP_LEDGER_H
#define RB_STEPPED_STEP_LEDGER_H

#include "stepped/tally.h"

/*
 * Of a cohort's step, whose points, blows and rebounds are still there, and are told; to the cohort
 * of all belongs what stands. `before`: the state that it began with, driven bodies with the
 * velocities of the step. Bodies with a mark in `skip` (or NULL) are left out.
 */
struct rb_entries rb_step_ledger_enter(struct rb_world *world, const struct rb_cohort *cohort,
                                       const struct rb_state *before, double start_s, double h_s,
                                       const unsigned char *skip);

#endif
