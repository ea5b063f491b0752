/* SPDX-License-Identifier: MIT */
/*
 * Point of action of an impulse between two bodies: one point of space, and between balls on the
 * line of their centres, so that it conserves the angular momentum of both.
 *
 * An impulse p of a step changes the angular momentum of a body by (x + r) x p, with its centre of
 * mass at x when the impulse acts: its later displacement along its velocity adds nothing. Points
 * that are found for the gap at another moment have arms r and normals of that moment; their error
 * here is of first order in the step.
 */
#ifndef RB_STEPPED_LEVERS_H
#define RB_STEPPED_LEVERS_H

#include "constraint/row.h"
#include "world/world.h"

/*
 * Whether only contacts could change angular momentum: joints and gravitation conserve it, and
 * nothing is static or driven. Elsewhere a contact keeps two points, an error within the tolerance;
 * but not impacts within a step (stepped/flight), at whose beginning bodies are far apart.
 */
bool rb_levers_matter(const struct rb_model *model);

/* Whether its arms are along normals and its inertia is a scalar, or it does not move. */
bool rb_levers_is_ball(const struct rb_world *world, int i);

/* Unit vector from ball to ball; the old normal if they have passed each other since. */
static inline rb_vec3 rb_levers_normal(rb_vec3 between, rb_vec3 was)
{
	return rb_vec3_dot(between, was) > 0 ? rb_vec3_unit(between, was) : was;
}

/*
 * Moves the ends of both arms, m, to a common point; `between`: from a's centre of mass to b's. A
 * ball's stays on its normal, so that only friction rotates it.
 */
void rb_levers_join(const struct rb_world *world, const int of[2], rb_vec3 between, rb_vec3 normal,
                    rb_vec3 arm[2]);

/* The same for the arms of a contact's row. */
void rb_levers_join_row(const struct rb_world *world, rb_vec3 between, struct rb_constraint *row);

/*
 * Moves the ends of the arms of a face's points into one plane, which changes neither normal
 * velocities nor torques of normal impulses. Where gaps differ, rotation would otherwise require
 * different slips of points on one line, and friction would creep against itself.
 */
void rb_levers_level(rb_vec3 nearest_a, rb_vec3 nearest_b, struct rb_constraint *row);

#endif
