/* SPDX-License-Identifier: MIT */
/*
 * Stops: limits of free coordinates, and ropes, which limit a length. While they hold they are rows
 * of located/joint_rows; this is about their impacts and the ends of these.
 */
#ifndef RB_LOCATED_JOINT_STOPS_H
#define RB_LOCATED_JOINT_STOPS_H

#include "constraint/simultaneous.h"
#include "located/joint_drives.h"
#include "located/joint_problem.h"

/*
 * Returns the first of the rows' joints with a stop that touches and approaches by more than
 * rounding, with `slack`, m/s, that of the velocities before; -1: none.
 */
int rb_joint_stops_hit(const struct rb_joint_rows *rows, double t, double slack);

/*
 * Eases touching stops whose rows are nearly dependent on those of joints: no force holds a rope
 * that is perpendicular to all possible motions of its bodies, such as one of the least distance
 * between two that slide side by side. They are open until they are exceeded by a share of the
 * joint's size, within the error allowed for joints; there they are independent enough to hold, or
 * bodies do not get there. Stops that are hit there and still dependent are a failure (l->status).
 * Stops that have opened again are restored.
 */
void rb_joint_stops_ease(const struct rb_joint_rows *rows, double t);

/* Returns a dynamic body of the joint. */
int rb_joint_stops_body(const struct rb_located *l, int joint);

/*
 * If rebounds of contacts end: stops drives that would reach their speed within rounding, which
 * changes velocities of the solution. Otherwise a rocking box and a joint with friction would
 * alternate without end.
 */
void rb_joint_stops_end_drives(const struct rb_joint_rows *rows, struct rb_simultaneous *joint,
                               struct rb_pose *pose, double t, double slack);

/*
 * After an impact, with bodies by place and the rows of joints `rows`: sets restitution to zero for
 * stops whose infinite series of rebounds would stay within rounding. True: there are some, and the
 * impact must be repeated. Leaves drives and stops in the modes of the new velocities. l->status:
 * out of memory.
 */
bool rb_joint_stops_end(const struct rb_joint_rows *rows, const struct rb_simultaneous *joint,
                        double t);

/*
 * After an impact: drives that held, and whose speeds are now off by less than they would correct
 * within rounding of sizes, must take part in it (rb_joint_row.impulse_max): if they corrected that
 * one after the other, the same stops would be hit again, at the speed of a fall through their
 * rounding. True: there are some, and the impact must be repeated with new rows.
 */
bool rb_joint_stops_include(const struct rb_joint_rows *rows, const struct rb_simultaneous *joint);

/*
 * After an impact, before poses have its velocities: enters the work of joints, and records the
 * stops that were hit. A failure sets l->status.
 */
void rb_joint_stops_enter_impact(const struct rb_joint_rows *rows,
                                 const struct rb_simultaneous *joint, double t);

/* Records drives and ropes that have begun or ceased to hold, from their modes. */
void rb_joint_stops_note(const struct rb_joint_rows *rows, double t);

#endif
