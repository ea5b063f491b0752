/* SPDX-License-Identifier: MIT */
/*
 * Trees of joints among the bodies of a cluster (step/joint_tree), in reduced coordinates, and when
 * they do not apply.
 *
 * The rows of located/joint_rows are used instead if there are loops, contacts, motors or stops
 * that hold; for the errors of joints; and if the results differ (rb_articulated_agrees).
 */
#ifndef RB_LOCATED_ARTICULATED_H
#define RB_LOCATED_ARTICULATED_H

#include "step/joint_tree.h"
#include "located/joint_rows.h"

/*
 * Creates the trees of the bodies of `rows`, in the arena; uses only bodies, poses and joints of
 * these, now and later. NULL: rows are needed. False: out of memory.
 */
bool rb_articulated_take(const struct rb_joint_rows *rows, struct rb_joint_tree **found);

/*
 * Are the accelerations those by rows, to rounding? `known`: the latter, [body_count][2], linear
 * and angular; `max`: the largest acceleration that they balance, m/s^2.
 */
bool rb_articulated_agrees(const struct rb_joint_rows *rows, double max, const rb_vec3 *linear,
                           const rb_vec3 *angular, const rb_vec3 *known);

#endif
