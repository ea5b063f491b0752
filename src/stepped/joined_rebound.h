/* SPDX-License-Identifier: MIT */
/*
 * Impacts of joined bodies, which rebound when the step is over, by the law of
 * constraint/simultaneous: the pass of impacts within a step (stepped/impact_pass) knows no joints.
 *
 * The step's solution v has stopped whatever approaches, all of it at once. With u the velocities
 * before the step, L(u) what the law makes of them, and P(u) what stopping makes of them, as far as
 * v has stopped them, bodies go on with
 *
 *     v + L(u) - P(u)
 *
 * so that what the forces of the step have done stays, and a cradle on rods does what one does
 * whose balls hang free: to add restitution to what was stopped at once would throw all of them.
 *
 * Rows are those of the step's solution, turned to where bodies stand now; what it has not closed
 * takes no part. Limits and ropes are among them, by their own restitution. Any worker, groups
 * apart from each other.
 *
 * Where nothing is given back, L is P, but of an eccentric impact with friction of what no joint
 * holds: ropes that hang slack.
 */
#ifndef RB_STEPPED_JOINED_REBOUND_H
#define RB_STEPPED_JOINED_REBOUND_H

#include "stepped/islands.h"

/* Whether the impact at a point is one of these last, as the step has been solved. */
bool rb_joined_rebound_is_due(const struct rb_solver *solver, const struct rb_world *world,
                              const struct rb_step_points *points,
                              const struct rb_step_point *point);

/*
 * Leaves in the group's rows the impulses of L less those of P, and adds to its bodies what these
 * do. False: nothing has changed, since the group has no joints, is larger than the law is for
 * (RB_IMPACT_CONTACTS), is of one limit or rope alone, or has not settled.
 */
bool rb_joined_rebound(struct rb_solver *solver, const struct rb_world *world,
                       const struct rb_step_points *points, const struct rb_island *island,
                       struct rb_arena *arena);

#endif
