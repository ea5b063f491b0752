/* SPDX-License-Identifier: MIT */
/*
 * Impacts of bodies with joints, which rebound at the end of the step, by the law of
 * constraint/simultaneous: the impact pass within a step (stepped/impact_pass) does not handle
 * joints.
 *
 * The step's solution v has stopped all approaching rows at once. With u the velocities before the
 * step, L(u) the result of the law, and P(u) that of stopping, to the extent that v has stopped
 * them, bodies continue with
 *
 *     v + L(u) - P(u)
 *
 * so that the effect of the step's forces is kept, and a cradle on rods behaves like one whose
 * balls hang freely: restitution added to bodies that were all stopped at once would throw all of
 * them.
 *
 * Rows are those of the step's solution, moved to the present poses; rows that it has not closed
 * take no part. Limits and ropes are among them, with their own restitution. Any worker, islands
 * separately.
 *
 * Without restitution, L is P, except for the impact with friction of a single contact: of bodies
 * that joints hold (constraint/jointed_impact), or, where it is eccentric, that only slack ropes
 * join.
 */
#ifndef RB_STEPPED_JOINED_REBOUND_H
#define RB_STEPPED_JOINED_REBOUND_H

#include "stepped/islands.h"

/*
 * Whether the impact at a point, after the step's solution, is one of the latter; `single`: no
 * other contact of its island touches.
 */
bool rb_joined_rebound_is_due(const struct rb_solver *solver, const struct rb_world *world,
                              const struct rb_step_points *points,
                              const struct rb_step_point *point, bool single);

/*
 * Sets the island's rows to the impulses of L minus those of P, and applies these to its bodies.
 * False: nothing has changed, since the island has no joints, is larger than the law's limit
 * (RB_IMPACT_CONTACTS), consists of one limit or rope alone, or the law has not converged.
 */
bool rb_joined_rebound(struct rb_solver *solver, const struct rb_world *world,
                       const struct rb_step_points *points, const struct rb_island *island,
                       struct rb_arena *arena);

#endif
