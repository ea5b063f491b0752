/* SPDX-License-Identifier: MIT */
/*
 * Stops: limits of free coordinates, and ropes, which are a limit of a length. While they hold they
 * are rows of located/joint_rows; here is how they come to touch, and what their impacts leave.
 */
#ifndef RB_LOCATED_JOINT_STOPS_H
#define RB_LOCATED_JOINT_STOPS_H

#include "constraint/simultaneous.h"
#include "located/joint_drives.h"
#include "located/joint_problem.h"

/*
 * The first of the rows' joints of which a stop touches and approaches beyond rounding, `slack`,
 * m/s, of velocities that have come in; -1: none.
 */
int rb_joint_stops_hit(const struct rb_joint_rows *rows, double t, double slack);

/*
 * Eases stops that touch and of whose rows joints leave next to nothing: no force holds a rope that
 * is across to all that its bodies may do, such as one of the least distance of two that slide side
 * by side. They are open until they are exceeded by a share of the joint's size, within what joints
 * may be open; there so much is left that they hold, or bodies do not get there. Those that are hit
 * there although too little is left are a failure (l->status). Stops that have opened again are as
 * they are said to be.
 */
void rb_joint_stops_ease(const struct rb_joint_rows *rows, double t);

/* A body of the joint that yields. */
int rb_joint_stops_body(const struct rb_located *l, int joint);

/*
 * Where rebounds of contacts end: stops drives that would come to their speed within rounding,
 * which changes velocities of the solution. Else a box that rocks and a joint that rubs go on in
 * turn.
 */
void rb_joint_stops_end_drives(const struct rb_joint_rows *rows, struct rb_simultaneous *joint,
                               struct rb_pose *pose, double t, double slack);

/*
 * After an impact, whose bodies are by place and whose rows of joints are `rows`: stops of which
 * infinitely many rebounds would follow within rounding lose their restitution in the problem.
 * True: there are some, and the impact is to be taken anew. Drives and stops are left in the modes
 * that the new velocities say. l->status: no memory.
 */
bool rb_joint_stops_end(const struct rb_joint_rows *rows, const struct rb_simultaneous *joint,
                        double t);

/*
 * After an impact: drives that held, and that it leaves off their speeds by what they would take
 * back within rounding of sizes, are to take part in it (rb_joint_row.impulse_max): what they would
 * take back one after the other, the same stops would meet again, at the speed of a fall through
 * their rounding. True: there are some, and the impact is to be taken anew, with rows posed again.
 */
bool rb_joint_stops_include(const struct rb_joint_rows *rows, const struct rb_simultaneous *joint);

/*
 * After an impact, before poses have its velocities: enters what joints have taken and given, and
 * records the stops that were met. A failure sets the located status.
 */
void rb_joint_stops_enter_impact(const struct rb_joint_rows *rows,
                                 const struct rb_simultaneous *joint, double t);

/* Records drives and ropes that have begun or ended to hold, by their modes. */
void rb_joint_stops_note(const struct rb_joint_rows *rows, double t);

#endif
