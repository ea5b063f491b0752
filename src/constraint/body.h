/* SPDX-License-Identifier: MIT */
/*
 * A body as all constraint solvers use it, and the only place that applies inverse inertias.
 *
 * 64 bytes, a cache line, because sweeps read two bodies for each row. Inverse inertias that are
 * not isotropic are stored beside the bodies, in one of two forms:
 *
 *     tensor   I^-1, world axes: one product                          (sweeps, factors)
 *     root     H with H^T H = I^-1: for needles, the tensor itself would lose to rounding all but
 *              the rotation about their axis                    (constraint/cone, simultaneous)
 *
 * Plain data, owned by the caller.
 */
#ifndef RB_CONSTRAINT_BODY_H
#define RB_CONSTRAINT_BODY_H

#include <math.h>
#include <stdbool.h>

#include "math/mat3.h"
#include "math/vec3.h"

/* Velocities for impacts and steps; accelerations for forces. */
struct rb_solver_body {
	/* m/s, rad/s or m/s^2, rad/s^2 (forces, without those of constraints): in and out */
	rb_vec3 linear, angular;
	double inverse_mass; /* 1/kg; 0: static or driven, which may still move */
	/* 1/(kg m^2) if isotropic; 0: does not rotate; NAN: see its tensor or root */
	double inverse_inertia;
};

_Static_assert(sizeof(struct rb_solver_body) == 64, "a body is a cache line");

/*
 * Bodies of a problem; tensor and root are indexed by body, and read if its inverse_inertia is NAN.
 */
struct rb_solver_bodies {
	struct rb_solver_body *body;
	const rb_mat3 *tensor; /* world axes; NULL: `root` is given, or no body needs one */
	const rb_mat3 *root;
};

static inline bool rb_solver_is_dynamic(const struct rb_solver_body *body)
{
	return body->inverse_mass > 0 || body->inverse_inertia != 0;
}

/* H^T (H torque); not inlined, so that code that uses tensors stays short. */
rb_vec3 rb_solver_turn_by_root(const rb_mat3 *root, rb_vec3 torque);

/*
 * Change of the spin of body i by an angular impulse (or of its angular acceleration by a torque).
 */
static inline rb_vec3 rb_solver_turn(const struct rb_solver_bodies *bodies, int i, rb_vec3 torque)
{
	const double inverse = bodies->body[i].inverse_inertia;

	if (!isnan(inverse))
		return rb_vec3_scale(inverse, torque);
	if (bodies->tensor)
		return rb_mat3_apply(&bodies->tensor[i], torque);
	return rb_solver_turn_by_root(&bodies->root[i], torque);
}

/* Velocity of the point at `arm` from the centre of mass. */
static inline rb_vec3 rb_solver_point_velocity(const struct rb_solver_body *body, rb_vec3 arm)
{
	return rb_vec3_add(body->linear, rb_vec3_cross(body->angular, arm));
}

/* Applies an impulse, or a force, at `arm`. */
static inline void rb_solver_apply(const struct rb_solver_bodies *bodies, int i, rb_vec3 arm,
                                   rb_vec3 impulse)
{
	struct rb_solver_body *const body = &bodies->body[i];

	body->linear = rb_vec3_add_scaled(body->linear, body->inverse_mass, impulse);
	if (body->inverse_inertia != 0)
		body->angular = rb_vec3_add(body->angular,
		                            rb_solver_turn(bodies, i, rb_vec3_cross(arm, impulse)));
}

#endif
