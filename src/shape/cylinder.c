/* SPDX-License-Identifier: MIT */
/* A cylinder about local z, with flat ends. */
#include <math.h>

#include "shape/shape_types.h"

#define AT(member) offsetof(struct rb_body_def, shape.member)

static const struct rb_row keys[] = {
	{"radius", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(radius), NULL, "required", "m", ""},
	{"length", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(size[2]), NULL, "required", "m",
         "from one flat end to the other"},
};

static double volume(const struct rb_shape *shape)
{
	return RB_PI * shape->radius * shape->radius * shape->size[2];
}

static rb_mat3 inertia(const struct rb_shape *shape, double mass)
{
	const double r = shape->radius, length = shape->size[2];
	const double across = mass * (r * r / 4 + length * length / 12);

	return rb_mat3_diagonal(across, across, 0.5 * mass * r * r);
}

static double reach(const struct rb_shape *shape)
{
	return hypot(shape->radius, 0.5 * shape->size[2]);
}

static double half_width(const struct rb_shape *shape)
{
	return fmin(shape->radius, 0.5 * shape->size[2]);
}

static enum rb_status core(const struct rb_shape *shape, rb_core *core, struct rb_error *err)
{
	(void)err;
	*core = rb_core_of_cylinder(shape->radius, 0.5 * shape->size[2]);
	return RB_OK;
}

static rb_vec3 half(const struct rb_shape *shape)
{
	return (rb_vec3){shape->radius, shape->radius, 0.5 * shape->size[2]};
}

/* Radial and axial excess; the third direction never limits. */
static double distance(const struct rb_shape *shape, rb_vec3 point)
{
	return rb_shape_beyond((rb_vec3){hypot(point.x, point.y) - shape->radius,
	                                 fabs(point.z) - 0.5 * shape->size[2], -(double)INFINITY});
}

const struct rb_shape_type rb_shape_cylinder = {
	.name = "cylinder",
	.plural = "cylinders",
	.form = RB_FORM_CYLINDER,
	.reads = RB_SHAPE_READS_RADIUS | RB_SHAPE_READS_SIZE_Z,
	.key = keys,
	.key_count = sizeof keys / sizeof keys[0],
	.is_part = true,
	.fault = rb_shape_fault_of_round,
	.volume = volume,
	.inertia = inertia,
	.reach = reach,
	.half_width = half_width,
	.core = core,
	.half = half,
	.distance = distance,
};
