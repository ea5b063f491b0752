/* SPDX-License-Identifier: MIT */
/*
 * Where an impulse between two bodies acts: at one point of space, and between balls along the line
 * of their centres, so that it leaves the angular momentum of both as it is.
 *
 * An impulse p of a step changes the angular momentum of a body by (x + r) x p, with its centre of
 * mass at x as the impulse acts: what it moves by afterwards, along its velocity, adds nothing.
 * Points that are found for the gap at another moment have arms r and normals of that moment; what
 * these miss here is of the first order in the step.
 */
#ifndef RB_STEPPED_LEVERS_H
#define RB_STEPPED_LEVERS_H

#include "constraint/row.h"
#include "world/world.h"

/*
 * Whether only contacts could change the angular momentum: joints and attraction leave it, and
 * nothing stands still or is driven. Elsewhere gaps leave two points, a matter of tolerance; not
 * so impacts in their time (stepped/flight), as whose step begins bodies are far apart.
 */
bool rb_levers_matter(const struct rb_model *model);

/* Whether its arms lie along normals and its inertia is a number, or nothing moves it. */
bool rb_levers_is_ball(const struct rb_world *world, int i);

/* From ball to ball, unit; the normal that was where they have passed each other since. */
static inline rb_vec3 rb_levers_normal(rb_vec3 between, rb_vec3 was)
{
	return rb_vec3_dot(between, was) > 0 ? rb_vec3_unit(between, was) : was;
}

/*
 * Moves the ends of both arms, m, to one point; `between`: b's centre of mass from a's. A ball's
 * stays on its normal, so that nothing but friction turns it.
 */
void rb_levers_join(const struct rb_world *world, const int of[2], rb_vec3 between, rb_vec3 normal,
                    rb_vec3 arm[2]);

/* The same for the arms of a contact's row. */
void rb_levers_join_row(const struct rb_world *world, rb_vec3 between, struct rb_constraint *row);

/*
 * Arms of a face end in one plane, which no normal velocity sees and no torque of a push. Where
 * gaps differ, turning would else ask for different slips of points on one line, and friction would
 * creep on against itself.
 */
void rb_levers_level(rb_vec3 nearest_a, rb_vec3 nearest_b, struct rb_constraint *row);

#endif
