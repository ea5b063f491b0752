/* SPDX-License-Identifier: MIT */
/*
 * One contact point of two bodies at a moment: what it is, and what counts as touching there.
 *
 * `a` and `b` are body indices in any order, normals point from a to b. Values.
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
	rb_vec3 point;       /* m, world: of the contact, on a surface */
	bool on_rim;         /* of a sphere: at an edge or corner of a rectangle */
	/*
	 * how far the point is from leaving its features, where others take over (< 0: it has left
	 * them, INFINITY: it cannot), and the derivative
	 */
	double inside, inside_rate; /* m, m/s */
	uint64_t beyond;            /* the key of these others, 0: they are to be searched for */
	struct rb_pose pose_a, pose_b;
	rb_vec3 arm_a, arm_b;   /* m, centres of mass to the point */
	rb_vec3 rate_a, rate_b; /* m/s: derivatives of the arms as the point moves along */
	rb_vec3 velocity;       /* m/s, of b's material at the point relative to a's */
};

static inline struct rb_contact_name rb_contact_name_of(const struct rb_contact_point *m)
{
	return (struct rb_contact_name){m->a, m->b, m->parts, m->key, m->half};
}

/* No: a sphere with a sphere, plane or rectangle, which have one point and no key. */
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

/*
 * m: how large the larger body of the two is (of those that move, where one does); a plane has no
 * size.
 */
double rb_contact_point_size(const struct rb_located *l, const struct rb_contact_point *m);
/* m: the larger of the two whether it moves or not, whose corners say where its faces are. */
double rb_contact_point_largest(const struct rb_located *l, const struct rb_contact_point *m);
/*
 * m: gaps up to here count as touching (rbsim-scene(5), TOUCHING AND AT REST), at this approach and
 * moment.
 */
double rb_contact_point_band(const struct rb_located *l, const struct rb_contact_point *m,
                             double t);
/*
 * m/s: rounding of the normal velocity, of speeds and of what weight makes of them in a fall by its
 * own size.
 */
double rb_contact_point_noise(const struct rb_located *l, const struct rb_contact_point *m);

/*
 * m/s^2: second derivative of the gap, on the arcs as they are at `t`, with the poses of the
 * contact point.
 */
double rb_contact_point_bend(const struct rb_located *l, const struct rb_contact_point *m,
                             double t);

/*
 * Do they only pass each other: does what they close with now turn back by itself before they are
 * deeper in each other than they touch by rounding? A gap that falls to nothing as x^2 / 2r has a
 * speed that is the root of its rounding.
 */
bool rb_contact_point_passes(const struct rb_located *l, const struct rb_contact_point *m,
                             double t);

/* Of a point that goes with the body in this pose; its acceleration on the arc as it is at `t`. */
rb_vec3 rb_contact_point_velocity(const struct rb_pose *pose, rb_vec3 point);
rb_vec3 rb_contact_point_acceleration(const struct rb_located *l, int i, const struct rb_pose *pose,
                                      rb_vec3 point, double t);

#endif
