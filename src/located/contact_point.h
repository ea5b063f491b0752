/* SPDX-License-Identifier: MIT */
/*
 * One contact point of two bodies at one time, and the tolerances within which it counts as
 * touching. `a` and `b` are body indices in any order, normals point from a to b. Values.
 */
#ifndef RB_LOCATED_CONTACT_POINT_H
#define RB_LOCATED_CONTACT_POINT_H

#include "constraint/contact_name.h"
#include "located/arc.h"

struct rb_contact_point {
	int a, b;
	uint32_t parts;
	uint64_t key;
	rb_vec3 half;        /* see struct rb_contact_name */
	double gap;          /* m */
	rb_vec3 normal;      /* unit, from a to b */
	rb_vec3 normal_rate; /* 1/s: its derivative */
	rb_vec3 point;       /* m, world: on the surface of one of them */
	bool on_rim;         /* of a sphere: at an edge or corner of a rectangle */
	/*
	 * distance from the border of its features, beyond which others take over (< 0: it is past
	 * it, INFINITY: it has none), and the derivative
	 */
	double inside, inside_rate; /* m, m/s */
	uint64_t beyond;            /* key of these others, 0: a search must find them */
	struct rb_pose pose_a, pose_b;
	rb_vec3 arm_a, arm_b;   /* m, from the centres of mass to the point */
	rb_vec3 rate_a, rate_b; /* m/s: derivatives of the arms as the point moves */
	rb_vec3 velocity;       /* m/s, of b's material at the point relative to a's */
};

static inline struct rb_contact_name rb_contact_name_of(const struct rb_contact_point *m)
{
	return (struct rb_contact_name){m->a, m->b, m->parts, m->key, m->half};
}

/* False for a sphere with a sphere, plane or rectangle, which have one point and no key. */
static inline bool rb_pair_has_features(const struct rb_located *l, int a, int b)
{
	const struct rb_shape *shape = l->model->shape;

	if (!l->model->parts)
		return false;
	return (shape[a].kind != RB_SHAPE_SPHERE && shape[b].kind != RB_SHAPE_SPHERE) ||
	       rb_shape_has_parts(shape[a].kind) || rb_shape_has_parts(shape[b].kind);
}

/*
 * Height of the smallest rebound of a corner in ulp of the size: its position is less exact than a
 * sphere's surface.
 */
enum { RB_SMALLEST_CORNER_ULP = 64 };

/* Size of the larger body, of those that move if one does, m; a plane has none. */
double rb_contact_point_size(const struct rb_located *l, const struct rb_contact_point *m);
/* Size of the larger body, moving or not, m: its corners determine the positions of its faces. */
double rb_contact_point_largest(const struct rb_located *l, const struct rb_contact_point *m);
/*
 * Largest gap that counts as touching (rbsim-scene(5), TOUCHING AND AT REST) at this approach
 * velocity and time, m.
 */
double rb_contact_point_band(const struct rb_located *l, const struct rb_contact_point *m,
                             double t);
/*
 * Rounding of the normal velocity, m/s: that of speeds, including the one reached in a fall by the
 * body's own size.
 */
double rb_contact_point_noise(const struct rb_located *l, const struct rb_contact_point *m);

/*
 * Second derivative of the gap, m/s^2, with the accelerations of the arcs at `t` and the poses of
 * the contact point.
 */
double rb_contact_point_gap_acceleration(const struct rb_located *l,
                                         const struct rb_contact_point *m, double t);

/*
 * True if the bodies only pass each other: the approach reverses by itself before the overlap
 * exceeds the rounding of a contact. A gap that vanishes as x^2 / 2r has a rate of the order of the
 * root of its rounding.
 */
bool rb_contact_point_passes(const struct rb_located *l, const struct rb_contact_point *m,
                             double t);

/* Velocity of a material point of the body in this pose; its acceleration on the arc at `t`. */
rb_vec3 rb_contact_point_velocity(const struct rb_pose *pose, rb_vec3 point);
rb_vec3 rb_contact_point_acceleration(const struct rb_located *l, int i, const struct rb_pose *pose,
                                      rb_vec3 point, double t);

#endif
