/* SPDX-License-Identifier: MIT */
/*
 * Signed gap between a sphere and another shape, in metres: negative is overlap, 0 is touching.
 *
 * Pure functions of world coordinates. `a` is always the sphere; `*normal` is a unit vector that
 * points from the sphere to the other body and is never NULL. Where geometry leaves it open
 * (coincident centres, a centre on the sheet of a rectangle) it is a fixed choice, so that repeated
 * runs agree.
 */
#ifndef RB_GEOM_DISTANCE_H
#define RB_GEOM_DISTANCE_H

#include <float.h>
#include <math.h>

#include "math/quat.h"

/* A finite plane in world coordinates: axes are unit vectors, half extents along x and y. */
typedef struct {
	rb_vec3 center, axis_x, axis_y, normal; /* m, 1, 1, 1 */
	double half_x, half_y;                  /* m */
} rb_rectangle;

static inline rb_rectangle rb_rectangle_of(rb_vec3 position, rb_quat orientation,
                                           const double size[2])
{
	const rb_mat3 r = rb_quat_to_mat3(orientation);

	return (rb_rectangle){
		.center = position,
		.axis_x = {r.m[0][0], r.m[1][0], r.m[2][0]},
		.axis_y = {r.m[0][1], r.m[1][1], r.m[2][1]},
		.normal = {r.m[0][2], r.m[1][2], r.m[2][2]},
		.half_x = 0.5 * size[0],
		.half_y = 0.5 * size[1],
	};
}

/*
 * The normal of an infinite plane: its local z. What a quaternion cannot tell from zero is zero, so
 * that a plane along the axes has a normal along them to the bit.
 */
static inline rb_vec3 rb_plane_normal(rb_quat orientation)
{
	const rb_vec3 n = rb_quat_rotate(orientation, (rb_vec3){0, 0, 1});
	const double least = 4 * DBL_EPSILON;

	return rb_vec3_unit((rb_vec3){fabs(n.x) > least ? n.x : 0, fabs(n.y) > least ? n.y : 0,
	                              fabs(n.z) > least ? n.z : 0},
	                    n);
}

/* |cb - ca| - (ra + rb); coincident centres: normal along z. */
static inline double rb_distance_sphere_sphere(rb_vec3 ca, double ra, rb_vec3 cb, double rb,
                                               rb_vec3 *normal)
{
	const rb_vec3 d = rb_vec3_sub(cb, ca);
	const double length = rb_vec3_length(d);

	*normal = length > 0 ? (rb_vec3){d.x / length, d.y / length, d.z / length}
	                     : (rb_vec3){0, 0, 1};
	return length - (ra + rb);
}

/* (c - p).n - r: the half-space behind the plane is solid, however deep the sphere is in it. */
static inline double rb_distance_sphere_plane(rb_vec3 c, double r, rb_vec3 plane_point,
                                              rb_vec3 plane_normal, rb_vec3 *normal)
{
	*normal = rb_vec3_neg(plane_normal);
	return rb_vec3_dot(rb_vec3_sub(c, plane_point), plane_normal) - r;
}

/*
 * Distance to the nearest point of the sheet, rim and corners included, less r. A centre on the
 * sheet counts as above it. `*closest` (may be NULL) is that nearest point.
 */
static inline double rb_distance_sphere_rectangle(rb_vec3 c, double r,
                                                  const rb_rectangle *rectangle, rb_vec3 *normal,
                                                  rb_vec3 *closest)
{
	const rb_vec3 d = rb_vec3_sub(c, rectangle->center);
	const double x = rb_vec3_dot(d, rectangle->axis_x);
	const double y = rb_vec3_dot(d, rectangle->axis_y);
	const double z = rb_vec3_dot(d, rectangle->normal);
	const double on_x = fmin(fmax(x, -rectangle->half_x), rectangle->half_x);
	const double on_y = fmin(fmax(y, -rectangle->half_y), rectangle->half_y);
	const double out_x = x - on_x, out_y = y - on_y;
	double length = fabs(z);

	if (out_x != 0 || out_y != 0) {
		length = rb_vec3_length((rb_vec3){out_x, out_y, z});
		*normal = rb_vec3_scale(-out_x / length, rectangle->axis_x);
		*normal = rb_vec3_add_scaled(*normal, -out_y / length, rectangle->axis_y);
		*normal = rb_vec3_add_scaled(*normal, -z / length, rectangle->normal);
	} else {
		*normal = z < 0 ? rectangle->normal : rb_vec3_neg(rectangle->normal);
	}
	if (closest) {
		*closest = rb_vec3_add_scaled(rectangle->center, on_x, rectangle->axis_x);
		*closest = rb_vec3_add_scaled(*closest, on_y, rectangle->axis_y);
	}
	return length - r;
}

#endif
