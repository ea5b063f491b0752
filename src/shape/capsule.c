/* SPDX-License-Identifier: MIT */
/* A cylinder about local z with a half ball at each end: all points no farther than `radius` from a
 * segment of `length`. */
#include <math.h>

#include "shape/shape_types.h"

#define AT(member) offsetof(struct rb_body_def, shape.member)

static const struct rb_row keys[] = {
	{"radius", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(radius), NULL, "required", "m", ""},
	{"length", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(size[2]), NULL, "required", "m",
         "of the straight part, without the round ends"},
};

static double volume(const struct rb_shape *shape)
{
	const double r = shape->radius;

	return RB_PI * r * r * (shape->size[2] + 4.0 / 3.0 * r);
}

/*
 * Tensor about the centre, kg m^2: a cylinder of mass `middle` and two half balls of together
 * `caps`, whose centroids lie 3/8 r beyond its ends; a half ball has 2/5 - 9/64 of its m r^2 across
 * about its centroid, and shifting it by length / 2 + 3/8 r gives the sum below.
 */
static rb_mat3 inertia(const struct rb_shape *shape, double mass)
{
	const double r = shape->radius, length = shape->size[2];
	const double caps = 4.0 / 3.0 * r / (length + 4.0 / 3.0 * r) * mass, middle = mass - caps;
	const double across = middle * (length * length / 12 + 0.25 * r * r) +
	                      caps * (0.4 * r * r + 0.25 * length * length + 0.375 * length * r);

	return rb_mat3_diagonal(across, across, (0.5 * middle + 0.4 * caps) * r * r);
}

static double reach(const struct rb_shape *shape)
{
	return shape->radius + 0.5 * shape->size[2];
}

static double half_width(const struct rb_shape *shape)
{
	return shape->radius;
}

static enum rb_status core(const struct rb_shape *shape, rb_core *core, struct rb_error *err)
{
	return rb_shape_core_of_segment(core, 0.5 * shape->size[2], shape->radius, err);
}

static rb_vec3 half(const struct rb_shape *shape)
{
	return (rb_vec3){shape->radius, shape->radius, reach(shape)};
}

/* The segment's nearest point has the same z, clamped to its ends. */
static double distance(const struct rb_shape *shape, rb_vec3 point)
{
	const double end = 0.5 * shape->size[2];

	point.z -= fmin(fmax(point.z, -end), end);
	return rb_vec3_length(point) - shape->radius;
}

const struct rb_shape_type rb_shape_capsule = {
	.name = "capsule",
	.plural = "capsules",
	.form = RB_FORM_CAPSULE,
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
