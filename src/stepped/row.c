/* SPDX-License-Identifier: MIT */
#include "stepped/row.h"

/* Rounding of a unit normal; of impulses, over the largest, besides that of velocities. */
static const double unit_error = 1e-9, impulse_error = 1e-9;

static bool is_sound(const struct rb_system_row *row, int bodies, double rounding)
{
	const double max = row->friction * row->push;

	/* what is not finite is for the judge of the step */
	if (!isfinite(row->push) || !rb_vec3_finite(row->friction_impulse) || !isfinite(rounding))
		return true;
	return row->a >= 0 && row->a < bodies && row->b >= 0 && row->b < bodies &&
	       row->a != row->b && fabs(rb_vec3_length(row->normal) - 1) <= unit_error &&
	       row->inverse_mass_n > 0 && row->inverse_mass_t > 0 && row->friction >= 0 &&
	       row->push >= 0 &&
	       rb_vec3_length(row->friction_impulse) <= max * (1 + impulse_error) + rounding &&
	       fabs(rb_vec3_dot(row->friction_impulse, row->normal)) <= rounding;
}

/* m/s: the largest speed that the velocity of a row is a difference of. */
static double speed_of(const struct rb_row_system *system, const struct rb_system_row *row)
{
	const struct rb_solver_body *a = &system->body[row->a], *b = &system->body[row->b];

	return rb_vec3_length(a->linear) + rb_vec3_length(b->linear) +
	       rb_vec3_length(a->angular) * rb_vec3_length(rb_system_arm_a(row)) +
	       rb_vec3_length(b->angular) * rb_vec3_length(rb_system_arm_b(row));
}

bool rb_system_is_sound(const struct rb_row_system *system, int bodies)
{
	double largest = DBL_MIN;

	for (int k = 0; k < system->row_count; k++)
		largest = fmax(largest, system->row[k].push);
	for (int k = 0; k < system->row_count; k++) {
		const struct rb_system_row *row = &system->row[k];
		const double rounding = impulse_error * largest + 64 * DBL_EPSILON *
		                                                          speed_of(system, row) /
		                                                          row->inverse_mass_n;

		if (!is_sound(row, bodies, rounding))
			return false;
	}
	return true;
}
