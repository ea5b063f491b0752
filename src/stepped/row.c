/* SPDX-License-Identifier: MIT */
#include "stepped/row.h"

/* Rounding of a unit normal, of friction at the edge of its cone, and of what is off its plane. */
static const double unit_error = 1e-9, cone_error = 1e-9, plane_error = 1e-9;

static bool has_sound_row(const struct rb_system_row *row, int bodies)
{
	const double max = row->friction * row->push;

	return row->a >= 0 && row->a < bodies && row->b >= 0 && row->b < bodies &&
	       row->a != row->b && fabs(rb_vec3_length(row->normal) - 1) <= unit_error &&
	       row->inverse_mass_n > 0 && row->inverse_mass_t > 0 && row->friction >= 0 &&
	       row->push >= 0 &&
	       rb_vec3_length(row->friction_impulse) <=
	               max * (1 + cone_error) + 16 * DBL_EPSILON * row->push + DBL_MIN &&
	       fabs(rb_vec3_dot(row->friction_impulse, row->normal)) <=
	               plane_error * (row->push + max) + DBL_MIN;
}

bool rb_system_is_sound(const struct rb_row_system *system, int bodies)
{
	for (int k = 0; k < system->row_count; k++)
		if (!has_sound_row(&system->row[k], bodies))
			return false;
	return true;
}
