/* SPDX-License-Identifier: MIT */
/*
 * Events of joints in a step that is kept: limits reached and ropes that become taut, which are
 * impacts at its end, and drives and ropes that start or cease to hold.
 *
 * Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_JOINT_RECORDS_H
#define RB_STEPPED_JOINT_RECORDS_H

#include "stepped/stepped_state.h"

/*
 * Appends them to rb_stepped's `reported`, before rb_joints_keep. Bodies with a mark in `skip` (may
 * be NULL) are left out. Fails on memory only.
 */
RB_CHECKED enum rb_status rb_joint_records_add(struct rb_world *world,
                                               const struct rb_cohort *cohort, double time_s,
                                               double h_s, const unsigned char *skip,
                                               struct rb_error *err);

#endif
