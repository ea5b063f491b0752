/* SPDX-License-Identifier: MIT */
/*
 * Trees of joints among the bodies of a cluster (step/joint_tree), and where they do not
 * hold.
 *
 * Rows are left to located/joint_rows: where there are rings, contacts, motors and stops that hold;
 * for the errors of joints; and where they say something else (rb_articulated_agrees).
 */
#ifndef RB_LOCATED_ARTICULATED_H
#define RB_LOCATED_ARTICULATED_H

#include "step/joint_tree.h"
#include "located/joint_rows.h"

/*
 * Trees of the bodies of rows, of which only bodies, poses and joints are used, now and later, in
 * the arena; NULL where rows are needed. False: no memory.
 */
bool rb_articulated_take(const struct rb_joint_rows *rows, struct rb_joint_tree **found);

/*
 * Are accelerations those that rows give, but for rounding? `known`: [body_count][2], linear and
 * angular; `max`: the largest acceleration that they are to balance, m/s^2.
 */
bool rb_articulated_agrees(const struct rb_joint_rows *rows, double max, const rb_vec3 *linear,
                           const rb_vec3 *angular, const rb_vec3 *known);

#endif
