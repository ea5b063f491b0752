/* SPDX-License-Identifier: MIT */
/*
 * Two bodies that rotate together about the normal of their contact, as a body that sticks to a
 * turntable: within a step their points move along chords, not along tangents. The mean of an arm
 * over the step makes its velocity that of the chord, so that a body that sticks stays in its
 * place.
 */
#ifndef RB_STEPPED_PIVOT_H
#define RB_STEPPED_PIVOT_H

#include <math.h>

#include "world/world.h"

/* Common rotation of both about `normal` within h_s, rad. */
static inline double rb_pivot_angle(const struct rb_world *world, int a, int b, rb_vec3 normal,
                                    double h_s)
{
	const double *const spin = world->state.spin;

	if (!spin || b >= world->model->body_count)
		return 0;
	const double turn_a = h_s * rb_vec3_dot(rb_vec3_from(spin + 3 * (size_t)a), normal);
	const double turn_b = h_s * rb_vec3_dot(rb_vec3_from(spin + 3 * (size_t)b), normal);

	if (!(turn_a * turn_b > 0))
		return 0;
	return fabs(turn_a) < fabs(turn_b) ? turn_a : turn_b;
}

/* Rotation about a normal, with a scale of the component across it. */
typedef struct {
	double cosine, sine;
} rb_pivot;

static inline rb_pivot rb_pivot_of(double angle)
{
	return (rb_pivot){cos(angle), sin(angle)};
}

/*
 * Mean of an arm that rotates by `angle`, != 0: (R(angle) - 1) arm is angle normal x this mean of
 * the arm.
 */
static inline rb_pivot rb_pivot_mean(double angle)
{
	const double half = 0.5 * angle, sine = sin(half), share = sine / half;

	return (rb_pivot){share * cos(half), share * sine};
}

static inline rb_vec3 rb_pivot_turn(rb_vec3 v, rb_vec3 normal, rb_pivot pivot)
{
	const rb_vec3 along = rb_vec3_scale(rb_vec3_dot(v, normal), normal);
	const rb_vec3 across = rb_vec3_sub(v, along);

	return rb_vec3_add(rb_vec3_add_scaled(along, pivot.cosine, across),
	                   rb_vec3_scale(pivot.sine, rb_vec3_cross(normal, across)));
}

#endif
