/* SPDX-License-Identifier: MIT */
/* All types of shapes, and what their files share. Pure functions. */
#ifndef RB_SHAPE_SHAPE_TYPES_H
#define RB_SHAPE_SHAPE_TYPES_H

#include "model/shape.h"

/*
 * All types: the end of the kind's name, and of the row's. A new one is a line here, one in enum
 * rb_shape_kind (after the last: recordings keep the numbers), and a file beside this one.
 */
#define RB_SHAPE_TYPES(TYPE)       \
	TYPE(SPHERE, sphere)       \
	TYPE(PLANE, plane)         \
	TYPE(RECTANGLE, rectangle) \
	TYPE(BOX, box)             \
	TYPE(CAPSULE, capsule)     \
	TYPE(CYLINDER, cylinder)   \
	TYPE(HULL, hull)           \
	TYPE(UNION, union)         \
	TYPE(TERRAIN, terrain)

#define RB_SHAPE_ROW(kind, name) extern const struct rb_shape_type rb_shape_##name;
RB_SHAPE_TYPES(RB_SHAPE_ROW)
#undef RB_SHAPE_ROW

#define RB_PI 3.14159265358979323846

static inline bool rb_is_positive(double x)
{
	return x > 0 && isfinite(x);
}

/* What is wrong with a shape that has a radius and a length along z; false: nothing. */
bool rb_shape_fault_of_round(const struct rb_shape *shape, char text[RB_SHAPE_FAULT_SIZE]);

/* A segment along local z, a point where half_length is zero, with a radius. */
RB_CHECKED enum rb_status rb_shape_core_of_segment(rb_core *core, double half_length, double radius,
                                                   struct rb_error *err);

/*
 * The distance to a body whose sides are at right angles to each other, from the distances to each
 * of them, d: that to the corner between them outside, to the nearest inside. m.
 */
double rb_shape_beyond(rb_vec3 d);

#endif
