/* SPDX-License-Identifier: MIT */
/* A finite plane in local z = 0, solid to both sides, without thickness: plane { size = ... }. */
#include <math.h>
#include <stdio.h>

#include "shape/shape_types.h"

static bool fault(const struct rb_shape *shape, char text[RB_SHAPE_FAULT_SIZE])
{
	if (rb_is_positive(shape->size[0]) && rb_is_positive(shape->size[1]))
		return false;
	snprintf(text, RB_SHAPE_FAULT_SIZE,
	         "'size' must be two positive finite lengths (got %g, %g m)", shape->size[0],
	         shape->size[1]);
	return true;
}

static enum rb_status core(const struct rb_shape *shape, rb_core *core, struct rb_error *err)
{
	struct rb_polytope *polytope = NULL;
	const enum rb_status status = rb_polytope_create_rectangle(&polytope, 0.5 * shape->size[0],
	                                                           0.5 * shape->size[1], err);

	if (status == RB_OK)
		*core = rb_core_of_polytope(polytope, 0);
	return status;
}

const struct rb_shape_type rb_shape_rectangle = {
	.name = "rectangle",
	.plural = "rectangles",
	.form = RB_FORM_SURFACE,
	.reads = RB_SHAPE_READS_SIZE_X | RB_SHAPE_READS_SIZE_Y,
	.fault = fault,
	.core = core,
};
