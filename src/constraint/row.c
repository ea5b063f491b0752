/* SPDX-License-Identifier: MIT */
#include "constraint/row.h"

#include <float.h>

#include "base/error.h"

/*
 * Rounding errors: of a unit normal; of impulses, relative to the largest, in addition to that of
 * velocities.
 */
static const double unit_error = 1e-9, impulse_error = 1e-9;

static bool is_in_set(const struct rb_constraint *row, double rounding)
{
	const double n = row->impulse.n, across = rb_vec3_length(row->impulse.t);

	if (fabs(rb_vec3_dot(row->impulse.t, row->normal)) > rounding)
		return false;
	switch (row->set) {
	case RB_CONSTRAINT_CONE:
		return row->friction >= 0 && n >= 0 && !row->couple &&
		       across <= row->friction * n * (1 + impulse_error) + rounding;
	case RB_CONSTRAINT_FREE:
		return true;
	case RB_CONSTRAINT_INTERVAL:
		return row->low <= row->high && row->softness >= 0 && n >= row->low - rounding &&
		       n <= row->high + rounding && across <= rounding;
	}
	return false;
}

static bool is_sound(const struct rb_constraint *row, int bodies, double rounding)
{
	/* the step's verdict detects values that are not finite */
	if (!isfinite(row->impulse.n) || !rb_vec3_finite(row->impulse.t) || !isfinite(rounding))
		return true;
	return row->a >= 0 && row->a < bodies && row->b >= 0 && row->b < bodies &&
	       row->a != row->b && fabs(rb_vec3_length(row->normal) - 1) <= unit_error &&
	       row->inverse_mass_n > 0 && row->inverse_mass_t > 0 &&
	       !(row->couple && row->central) && is_in_set(row, rounding);
}

/* Bound of the speeds whose difference is the row's velocity, m/s. */
static double speed_of(const struct rb_row_system *system, const struct rb_constraint *row)
{
	const struct rb_solver_body *a = &system->bodies.body[row->a];
	const struct rb_solver_body *b = &system->bodies.body[row->b];

	if (row->couple)
		return row->arm_a.x * (rb_vec3_length(a->angular) + rb_vec3_length(b->angular));
	return rb_vec3_length(a->linear) + rb_vec3_length(b->linear) +
	       rb_vec3_length(a->angular) * rb_vec3_length(rb_constraint_arm_a(row)) +
	       rb_vec3_length(b->angular) * rb_vec3_length(rb_constraint_arm_b(row));
}

bool rb_row_system_is_sound(const struct rb_row_system *system, int bodies)
{
	double largest = DBL_MIN;

	for (int k = 0; k < system->row_count; k++)
		largest = fmax(largest, fabs(system->row[k].impulse.n));
	for (int k = 0; k < system->row_count; k++) {
		const struct rb_constraint *row = &system->row[k];
		const double rounding = impulse_error * largest + 64 * DBL_EPSILON *
		                                                          speed_of(system, row) /
		                                                          row->inverse_mass_n;

		if (!is_sound(row, bodies, rounding))
			return false;
	}
	return true;
}

void rb_row_system_reject_normals(const struct rb_row_system *system)
{
	for (int k = 0; k < system->row_count; k++) {
		struct rb_constraint *row = &system->row[k];

		RB_ASSERT_COSTLY(fabs(rb_vec3_length(row->normal) - 1) <= unit_error);
		row->impulse.t = rb_vec3_reject(row->impulse.t, row->normal);
	}
}

rb_vec3 rb_constraint_couple_velocity(const struct rb_solver_bodies *bodies,
                                      const struct rb_constraint *row)
{
	return rb_vec3_scale(row->arm_a.x, rb_vec3_sub(bodies->body[row->b].angular,
	                                               bodies->body[row->a].angular));
}

static void apply_torque(const struct rb_solver_bodies *bodies, int i, rb_vec3 torque)
{
	struct rb_solver_body *const body = &bodies->body[i];

	if (body->inverse_inertia != 0)
		body->angular = rb_vec3_add(body->angular, rb_solver_turn(bodies, i, torque));
}

void rb_constraint_couple_apply(const struct rb_solver_bodies *bodies,
                                const struct rb_constraint *row, rb_vec3 impulse)
{
	const rb_vec3 torque = rb_vec3_scale(row->arm_a.x, impulse);

	apply_torque(bodies, row->a, rb_vec3_neg(torque));
	apply_torque(bodies, row->b, torque);
}

bool rb_row_system_is_of_contacts(const struct rb_row_system *system)
{
	for (int k = 0; k < system->row_count; k++)
		if (system->row[k].set != RB_CONSTRAINT_CONE)
			return false;
	return true;
}
