/* SPDX-License-Identifier: MIT */
/*
 * The table of shape types in the order of enum rb_shape_kind, whose numbers recordings keep, from
 * one list of names.
 */
#include "shape/shape_types.h"

#include <stdio.h>

#include "base/error.h"

#define ROW(kind, name) [RB_SHAPE_##kind] = &rb_shape_##name,
const struct rb_shape_type *const rb_shape_types[RB_SHAPE_KIND_COUNT] = {RB_SHAPE_TYPES(ROW)};

bool rb_shape_fault_of_round(const struct rb_shape *shape, char text[RB_SHAPE_FAULT_SIZE])
{
	if (rb_is_positive(shape->radius) && rb_is_positive(shape->size[2]))
		return false;
	snprintf(text, RB_SHAPE_FAULT_SIZE,
	         "'radius' and 'length' must be positive and finite (got %g and %g m)",
	         shape->radius, shape->size[2]);
	return true;
}

enum rb_status rb_shape_core_of_segment(rb_core *core, double half_length, double radius,
                                        struct rb_error *err)
{
	RB_ASSERT(half_length >= 0 && radius >= 0);

	struct rb_polytope *polytope = NULL;
	const enum rb_status status = rb_polytope_create_segment(&polytope, half_length, err);

	if (status == RB_OK)
		*core = rb_core_of_polytope(polytope, radius);
	return status;
}

double rb_shape_beyond(rb_vec3 d)
{
	const double largest = fmax(d.x, fmax(d.y, d.z));

	if (!(largest > 0))
		return largest;
	return rb_vec3_length((rb_vec3){fmax(d.x, 0), fmax(d.y, 0), fmax(d.z, 0)});
}
