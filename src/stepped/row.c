/* SPDX-License-Identifier: MIT */
#include "stepped/row.h"

/* Rounding of a unit normal; of impulses, over the largest of the system. */
static const double unit_error = 1e-9, impulse_error = 1e-9;

static bool is_sound(const struct rb_system_row *row, int bodies, double rounding)
{
	const double max = row->friction * row->push;

	return row->a >= 0 && row->a < bodies && row->b >= 0 && row->b < bodies &&
	       row->a != row->b && fabs(rb_vec3_length(row->normal) - 1) <= unit_error &&
	       row->inverse_mass_n > 0 && row->inverse_mass_t > 0 && row->friction >= 0 &&
	       row->push >= 0 &&
	       rb_vec3_length(row->friction_impulse) <= max * (1 + impulse_error) + rounding &&
	       fabs(rb_vec3_dot(row->friction_impulse, row->normal)) <= rounding;
}

bool rb_system_is_sound(const struct rb_row_system *system, int bodies)
{
	double largest = DBL_MIN;

	for (int k = 0; k < system->row_count; k++)
		largest = fmax(largest, system->row[k].push);
	for (int k = 0; k < system->row_count; k++)
		if (!is_sound(&system->row[k], bodies, impulse_error * largest))
			return false;
	return true;
}
