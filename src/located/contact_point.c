/* SPDX-License-Identifier: MIT */
#include "located/contact_point.h"

#include "base/error.h"

#include <float.h>

enum { TOUCHING_ULP = 8 };

/*
 * Size of a body, m: 0 for an infinite plane, so that the other body's size counts; rectangles have
 * one only in pairs with features.
 */
static double size_of(const struct rb_located *l, int i)
{
	const struct rb_shape *shape = &l->model->shape[i];

	if (shape->kind == RB_SHAPE_RECTANGLE)
		return 0.5 * (shape->size[0] + shape->size[1]);
	return shape->kind == RB_SHAPE_PLANE ? 0 : rb_model_reach(l->model, i);
}

static double plain_size_of(const struct rb_located *l, int i)
{
	return l->model->shape[i].kind == RB_SHAPE_SPHERE ? l->model->shape[i].radius : 0;
}

double rb_contact_point_size(const struct rb_located *l, const struct rb_contact_point *m)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	if (!rb_pair_has_features(l, m->a, m->b))
		return fmax(plain_size_of(l, m->a), plain_size_of(l, m->b));
	const double a = rb_located_fixed(l, m->a) ? 0 : size_of(l, m->a);
	const double b = rb_located_fixed(l, m->b) ? 0 : size_of(l, m->b);
	return fmax(a, b);
}

double rb_contact_point_largest(const struct rb_located *l, const struct rb_contact_point *m)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	return rb_pair_has_features(l, m->a, m->b) ? fmax(size_of(l, m->a), size_of(l, m->b))
	                                           : rb_contact_point_size(l, m);
}

double rb_contact_point_band(const struct rb_located *l, const struct rb_contact_point *m, double t)
{
	const bool plain = !rb_pair_has_features(l, m->a, m->b);
	double largest = rb_contact_point_largest(l, m);

	/*
	 * the reference point of an infinite plane is arbitrary: only the other body's position
	 * counts
	 */
	if (plain ? l->model->shape[m->a].kind == RB_SHAPE_SPHERE
	          : l->model->shape[m->a].kind != RB_SHAPE_PLANE)
		largest = fmax(largest, rb_vec3_max_abs(m->pose_a.origin));
	if (plain ? l->model->shape[m->b].kind == RB_SHAPE_SPHERE
	          : l->model->shape[m->b].kind != RB_SHAPE_PLANE)
		largest = fmax(largest, rb_vec3_max_abs(m->pose_b.origin));
	/* and the distance travelled within the rounding of time */
	return DBL_EPSILON *
	       (TOUCHING_ULP * largest + 2 * t * fabs(rb_vec3_dot(m->velocity, m->normal)));
}

double rb_contact_point_noise(const struct rb_located *l, const struct rb_contact_point *m)
{
	const double size = rb_contact_point_size(l, m);

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	return 8 * DBL_EPSILON *
	       (rb_vec3_max_abs(m->pose_a.velocity) + rb_vec3_max_abs(m->pose_b.velocity) +
	        rb_vec3_max_abs(m->pose_a.spin) * rb_vec3_max_abs(m->arm_a) +
	        rb_vec3_max_abs(m->pose_b.spin) * rb_vec3_max_abs(m->arm_b) +
	        sqrt(2 * l->weight * size));
}

bool rb_contact_point_passes(const struct rb_located *l, const struct rb_contact_point *m, double t)
{
	const double rate = rb_vec3_dot(m->velocity, m->normal),
		     bend = rb_contact_point_gap_acceleration(l, m, t);

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	return rate < -rb_contact_point_noise(l, m) && bend > 0 &&
	       rate * rate <= 2 * bend * (fmax(m->gap, 0) + rb_contact_point_band(l, m, t));
}

/* Angular acceleration; for free rotation from I w' = -w x I w. */
static rb_vec3 turning_of(const struct rb_located *l, int i, const struct rb_pose *pose, double t)
{
	if (i >= l->n || !l->top)
		return (rb_vec3){0, 0, 0};
	if (rb_located_on_piece(l, i))
		return rb_arc_piece_rate(&l->piece[i], RB_PIECE_SPIN, t);
	if (l->top_body[i].kind == RB_TOP_CONSTANT)
		return l->top[i].acceleration;
	return rb_top_turning(&l->top_body[i], rb_model_inertia(l->model, i), pose->orientation,
	                      pose->spin);
}

rb_vec3 rb_contact_point_velocity(const struct rb_pose *pose, rb_vec3 point)
{
	return rb_vec3_add(pose->velocity,
	                   rb_vec3_cross(pose->spin, rb_vec3_sub(point, pose->position)));
}

rb_vec3 rb_contact_point_acceleration(const struct rb_located *l, int i, const struct rb_pose *pose,
                                      rb_vec3 point, double t)
{
	const rb_vec3 arm = rb_vec3_sub(point, pose->position);
	const rb_vec3 a = rb_vec3_add(rb_arc_acceleration(l, i, t),
	                              rb_vec3_cross(turning_of(l, i, pose, t), arm));

	return rb_vec3_add(a, rb_vec3_cross(pose->spin, rb_vec3_cross(pose->spin, arm)));
}

/*
 * Time derivative of the normal component of b's velocity relative to a's at the point, which moves
 * along with its features.
 */
static double bend_of_features(const struct rb_located *l, const struct rb_contact_point *m,
                               double t)
{
	const rb_vec3 a = rb_vec3_add(
		rb_arc_acceleration(l, m->a, t),
		rb_vec3_add(rb_vec3_cross(turning_of(l, m->a, &m->pose_a, t), m->arm_a),
	                    rb_vec3_cross(m->pose_a.spin, m->rate_a)));
	const rb_vec3 b = rb_vec3_add(
		rb_arc_acceleration(l, m->b, t),
		rb_vec3_add(rb_vec3_cross(turning_of(l, m->b, &m->pose_b, t), m->arm_b),
	                    rb_vec3_cross(m->pose_b.spin, m->rate_b)));

	return rb_vec3_dot(rb_vec3_sub(b, a), m->normal) + rb_vec3_dot(m->velocity, m->normal_rate);
}

double rb_contact_point_gap_acceleration(const struct rb_located *l,
                                         const struct rb_contact_point *m, double t)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	if (rb_pair_has_features(l, m->a, m->b))
		return bend_of_features(l, m, t);
	const bool flipped = l->model->shape[m->a].kind != RB_SHAPE_SPHERE;
	const int i = flipped ? m->b : m->a, j = flipped ? m->a : m->b;
	const struct rb_pose *const ball = flipped ? &m->pose_b : &m->pose_a;
	const struct rb_pose *const other = flipped ? &m->pose_a : &m->pose_b;
	const rb_vec3 n = flipped ? rb_vec3_neg(m->normal) : m->normal;
	const rb_vec3 rate = flipped ? rb_vec3_neg(m->normal_rate) : m->normal_rate;
	const enum rb_shape_kind kind = l->model->shape[j].kind;
	const bool face = kind != RB_SHAPE_SPHERE && !m->on_rim;
	const rb_vec3 at = kind == RB_SHAPE_SPHERE || face
	                           ? other->origin
	                           : rb_vec3_add_scaled(m->point, m->gap, n);
	const rb_vec3 w = rb_vec3_sub(rb_contact_point_velocity(other, at),
	                              rb_contact_point_velocity(ball, ball->origin));
	const rb_vec3 a = rb_vec3_sub(rb_contact_point_acceleration(l, j, other, at, t),
	                              rb_contact_point_acceleration(l, i, ball, ball->origin, t));

	/*
	 * the gap is |d| - r if the normal follows d; (p - x) . n - r for a face, whose normal
	 * rotates with it
	 */
	if (!face)
		return rb_vec3_dot(a, n) + rb_vec3_dot(w, rate);
	const rb_vec3 turn = rb_vec3_add(rb_vec3_cross(turning_of(l, j, other, t), n),
	                                 rb_vec3_cross(other->spin, rate));
	return rb_vec3_dot(a, n) + 2 * rb_vec3_dot(w, rate) +
	       rb_vec3_dot(rb_vec3_sub(at, ball->origin), turn);
}
