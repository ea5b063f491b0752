/* SPDX-License-Identifier: MIT */
/* A ball about its origin. */
#include <math.h>
#include <stdio.h>

#include "shape/shape_types.h"

#define AT(member) offsetof(struct rb_body_def, shape.member)

static const struct rb_row keys[] = {
	{"radius", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(radius), NULL, "required", "m", ""},
};

static bool fault(const struct rb_shape *shape, char text[RB_SHAPE_FAULT_SIZE])
{
	if (rb_is_positive(shape->radius))
		return false;
	snprintf(text, RB_SHAPE_FAULT_SIZE, "'radius' must be positive and finite (got %g m)",
	         shape->radius);
	return true;
}

static double volume(const struct rb_shape *shape)
{
	const double r = shape->radius;

	return 4.0 / 3.0 * RB_PI * r * r * r;
}

static rb_mat3 inertia(const struct rb_shape *shape, double mass)
{
	const double moment = 0.4 * mass * shape->radius * shape->radius;

	return rb_mat3_diagonal(moment, moment, moment);
}

static double radius(const struct rb_shape *shape)
{
	return shape->radius;
}

static enum rb_status core(const struct rb_shape *shape, rb_core *core, struct rb_error *err)
{
	return rb_shape_core_of_segment(core, 0, shape->radius, err);
}

static rb_vec3 half(const struct rb_shape *shape)
{
	return (rb_vec3){shape->radius, shape->radius, shape->radius};
}

static double distance(const struct rb_shape *shape, rb_vec3 point)
{
	return rb_vec3_length(point) - shape->radius;
}

const struct rb_shape_type rb_shape_sphere = {
	.name = "sphere",
	.plural = "spheres",
	.form = RB_FORM_BALL,
	.reads = RB_SHAPE_READS_RADIUS,
	.key = keys,
	.key_count = sizeof keys / sizeof keys[0],
	.texture = "beachball", /* so that rotation shows */
	.is_part = true,
	.fault = fault,
	.volume = volume,
	.inertia = inertia,
	.reach = radius,
	.half_width = radius,
	.core = core,
	.half = half,
	.distance = distance,
};
