/* SPDX-License-Identifier: MIT */
/*
 * Accelerations of bodies whose joints form trees, without an unknown of any joint.
 *
 * From the leaves on, what a body and all that hangs on it answers to accelerations is an inertia
 * of six by six, the articulated one, of which what the joint to the next body leaves free is taken
 * away; from the roots on accelerations follow (Featherstone, Int. J. Robotics Research 2 (1983)
 * 13). Each joint costs the same, a hinge an eighth of its five rows in located/coupled. Unknowns
 * are what constraints add to the accelerations that bodies have without: those of free fall are
 * exact.
 *
 * Rows are left to located/joint_rows: where there are rings, contacts, motors and stops that hold;
 * for the errors of joints; and where they say something else (rb_articulated_agrees).
 */
#ifndef RB_LOCATED_ARTICULATED_H
#define RB_LOCATED_ARTICULATED_H

#include "located/joint_rows.h"

struct rb_articulated; /* in the arena */

/*
 * Trees of the bodies of rows, of which only bodies, poses and joints are used, now and later;
 * NULL where rows are needed. False: no memory.
 */
bool rb_articulated_take(const struct rb_joint_rows *rows, struct rb_articulated **found);

/* Adds to accelerations, by place, which are those without joints, what joints make of them. */
void rb_articulated_accelerate(struct rb_articulated *tree, double t, rb_vec3 *linear,
                               rb_vec3 *angular);

/*
 * Are accelerations those that rows give, but for rounding? `known`: [body_count][2], linear and
 * angular; `max`: the largest acceleration that they are to balance, m/s^2.
 */
bool rb_articulated_agrees(const struct rb_joint_rows *rows, double max, const rb_vec3 *linear,
                           const rb_vec3 *angular, const rb_vec3 *known);

/* After rb_articulated_accelerate: what joints exert from outside, added to rates by cause. */
void rb_articulated_enter(const struct rb_articulated *tree, struct rb_entries *rate);

#endif
