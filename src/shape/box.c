/* SPDX-License-Identifier: MIT */
/*
 * A box about its origin with edges along its axes: the only polytope with a closed-form support
 * function (geom/polytope), hence a type of its own and not a hull of eight points.
 */
#include <math.h>
#include <stdio.h>

#include "base/error.h"
#include "shape/shape_types.h"

#define AT(member) offsetof(struct rb_body_def, shape.member)

static const struct rb_row keys[] = {
	{"size", RB_ROW_NUMBERS, RB_RANGE_POSITIVE, 3, AT(size), NULL, "required", "m",
         "{x, y, z}: lengths of its edges"},
};

static bool fault(const struct rb_shape *shape, char text[RB_SHAPE_FAULT_SIZE])
{
	if (rb_is_positive(shape->size[0]) && rb_is_positive(shape->size[1]) &&
	    rb_is_positive(shape->size[2]))
		return false;
	snprintf(text, RB_SHAPE_FAULT_SIZE,
	         "'size' must be three positive finite lengths (got %g, %g, %g m)", shape->size[0],
	         shape->size[1], shape->size[2]);
	return true;
}

static double volume(const struct rb_shape *shape)
{
	return shape->size[0] * shape->size[1] * shape->size[2];
}

static rb_mat3 inertia(const struct rb_shape *shape, double mass)
{
	RB_ASSERT_COSTLY(!(mass < 0));
	const double *const s = shape->size;

	return rb_mat3_diagonal(mass / 12 * (s[1] * s[1] + s[2] * s[2]),
	                        mass / 12 * (s[0] * s[0] + s[2] * s[2]),
	                        mass / 12 * (s[0] * s[0] + s[1] * s[1]));
}

static double reach(const struct rb_shape *shape)
{
	return 0.5 * hypot(hypot(shape->size[0], shape->size[1]), shape->size[2]);
}

static double half_width(const struct rb_shape *shape)
{
	return 0.5 * fmin(shape->size[0], fmin(shape->size[1], shape->size[2]));
}

static rb_vec3 half(const struct rb_shape *shape)
{
	return (rb_vec3){0.5 * shape->size[0], 0.5 * shape->size[1], 0.5 * shape->size[2]};
}

static enum rb_status core(const struct rb_shape *shape, rb_core *core, struct rb_error *err)
{
	struct rb_polytope *polytope = NULL;
	const enum rb_status status = rb_polytope_create_box(&polytope, half(shape), err);

	if (status == RB_OK)
		*core = rb_core_of_polytope(polytope, 0);
	return status;
}

static double distance(const struct rb_shape *shape, rb_vec3 point)
{
	const rb_vec3 h = half(shape);

	return rb_shape_beyond(
		(rb_vec3){fabs(point.x) - h.x, fabs(point.y) - h.y, fabs(point.z) - h.z});
}

const struct rb_shape_type rb_shape_box = {
	.name = "box",
	.plural = "boxes",
	.form = RB_FORM_BOX,
	.reads = RB_SHAPE_READS_SIZES,
	.key = keys,
	.key_count = sizeof keys / sizeof keys[0],
	.is_part = true,
	.fault = fault,
	.volume = volume,
	.inertia = inertia,
	.reach = reach,
	.half_width = half_width,
	.core = core,
	.half = half,
	.distance = distance,
};
