/* SPDX-License-Identifier: MIT */
/*
 * What joints have done in a step that is kept, as events: limits met and ropes come taut, which
 * are impacts at its end, and drives and ropes that hold from then on or no longer.
 *
 * Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_JOINT_RECORDS_H
#define RB_STEPPED_JOINT_RECORDS_H

#include "stepped/stepped_state.h"

/*
 * Adds them to those told (rb_stepped's `reported`), before rb_joints_keep. Bodies with a mark in
 * `skip` (may be NULL) are left out. Fails on memory only.
 */
RB_CHECKED enum rb_status rb_joint_records_add(struct rb_world *world,
                                               const struct rb_cohort *cohort, double time_s,
                                               double h_s, const unsigned char *skip,
                                               struct rb_error *err);

#endif
