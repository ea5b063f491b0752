/* SPDX-License-Identifier: MIT */
/*
 * Overlap that linearization has left, closed by moving positions only: groups that overlap, each
 * until it does not, by a step of length 1 s from rest (constraint/row). Contacts of the located
 * method are put right otherwise (located/drift): they are held from both sides.
 */
#ifndef RB_STEPPED_PROJECTION_H
#define RB_STEPPED_PROJECTION_H

#include "stepped/depth.h"
#include "stepped/stepped_state.h"

/*
 * Overlaps of the cohort's candidates among bodies that are not bad; those that do not close are
 * blamed. What is left stands in `found`. Once one is blamed in a cohort that does not divide,
 * nothing more is moved.
 */
RB_CHECKED enum rb_status rb_projection_close(struct rb_world *world, struct rb_cohort *cohort,
                                              struct rb_depths *found, struct rb_error *err);

/*
 * m: what moving positions is for; a deeper overlap is looked at again, stepped/relinearize. And
 * what is too deep for it: the try is bad.
 */
double rb_projection_max(const struct rb_world *world, const struct rb_deep *deep, double h);
double rb_projection_lost(const struct rb_world *world, const struct rb_deep *deep, double h);

#endif
