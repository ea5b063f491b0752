/* SPDX-License-Identifier: MIT */
/*
 * Position projection: overlap left by linearization is closed by moving positions only. Groups
 * that overlap are solved as by a step of 1 s from rest (constraint/row), until none overlaps.
 * Contacts of the located method are bilateral and corrected by located/drift.
 */
#ifndef RB_STEPPED_PROJECTION_H
#define RB_STEPPED_PROJECTION_H

#include "stepped/depth.h"
#include "stepped/stepped_state.h"

/*
 * Overlaps of the cohort's candidates, without those of bad bodies; those that cannot be closed are
 * blamed. `found` gets what is left. Once a body is blamed in a cohort that does not divide,
 * nothing more is moved.
 */
RB_CHECKED enum rb_status rb_projection_close(struct rb_world *world, struct rb_cohort *cohort,
                                              struct rb_depths *found, struct rb_error *err);

/*
 * m: deepest overlap that the projection may close, beyond which the step is relinearized
 * (stepped/relinearize); and the depth beyond which the attempt is rejected.
 */
double rb_projection_max(const struct rb_world *world, const struct rb_deep *deep, double h);
double rb_projection_reject_depth(const struct rb_world *world, const struct rb_deep *deep,
                                  double h);

#endif
