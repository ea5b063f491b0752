/* SPDX-License-Identifier: MIT */
#include "located/mechanics.h"

#include "base/error.h"
#include "constraint/contact_row.h"
#include "constraint/effective_mass.h"
#include "located/external_force.h"

struct rb_solver_contact rb_mechanics_contact(const struct rb_located *l,
                                              const struct rb_contact_point *m)
{
	const struct rb_model *model = l->model;
	const struct rb_pair_material *pair = rb_contact_material(model, m->a, m->b);
	struct rb_solver_contact c = {.normal = m->normal,
	                              .arm_a = m->arm_a,
	                              .arm_b = m->arm_b,
	                              .friction = l->top ? pair->friction : 0,
	                              .restitution = pair->restitution};

	RB_ASSERT_COSTLY(rb_located_is_body(l, m->a) && rb_located_is_body(l, m->b));
	RB_ASSERT_COSTLY(fabs(rb_vec3_length(m->normal) - 1) < 1e-6);
	/*
	 * time derivatives of the points' relative velocity, and of the normal that it is measured
	 * along
	 */
	c.bias = rb_vec3_sub(rb_vec3_cross(m->pose_b.spin, m->rate_b),
	                     rb_vec3_cross(m->pose_a.spin, m->rate_a));
	c.bias = rb_vec3_add_scaled(c.bias, rb_vec3_dot(m->velocity, m->normal_rate), m->normal);
	return c;
}

struct rb_solver_body rb_mechanics_body(const struct rb_located *l, int i, rb_vec3 linear,
                                        rb_vec3 angular)
{
	struct rb_solver_body body = {
		.inverse_mass = l->model->inverse_mass[i], .linear = linear, .angular = angular};

	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	if (l->top)
		body.inverse_inertia = l->model->inverse_inertia_scalar[i];
	return body;
}

rb_mat3 rb_mechanics_root(const struct rb_located *l, int i, const struct rb_pose *pose)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	if (!l->top || !isnan(l->model->inverse_inertia_scalar[i]))
		return (rb_mat3){{{0}}};
	return rb_top_inverse_root(&l->top_body[i], rb_model_inertia(l->model, i),
	                           pose->orientation);
}

rb_vec3 rb_mechanics_turning(const struct rb_located *l, int i, double t)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	if (!l->top || !rb_located_on_piece(l, i))
		return (rb_vec3){0, 0, 0};
	return rb_arc_piece_rate(&l->piece[i], RB_PIECE_SPIN, t);
}

struct rb_solver_body rb_mechanics_fixed(const struct rb_located *l, int i, double t)
{
	return (struct rb_solver_body){.linear = rb_arc_acceleration(l, i, t),
	                               .angular = rb_mechanics_turning(l, i, t)};
}

rb_vec3 rb_mechanics_point_response(const struct rb_located *l, int i, const struct rb_pose *pose,
                                    rb_vec3 arm, rb_vec3 at, rb_vec3 impulse)
{
	const struct rb_mechanics_change change = rb_mechanics_change(l, i, pose->orientation, arm,
	                                                              impulse);

	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	return rb_vec3_add(change.linear, rb_vec3_cross(change.angular, at));
}

void rb_mechanics_add_effective_mass(const struct rb_located *l, int i, const struct rb_pose *pose,
                                     rb_vec3 arm, rb_mat3 *k)
{
	const rb_vec3 *const axis = rb_effective_mass_world;
	rb_vec3 spin[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

	for (int c = 0; c < 3 && l->top; c++)
		spin[c] = rb_inverse_inertia_apply(l, i, pose->orientation,
		                                   rb_vec3_cross(arm, axis[c]));
	rb_effective_mass_add_spins(l->model->inverse_mass[i], arm, axis, spin, k);
}

struct rb_mechanics_change rb_mechanics_change(const struct rb_located *l, int i,
                                               rb_quat orientation, rb_vec3 arm, rb_vec3 impulse)
{
	struct rb_mechanics_change change = {
		.linear = rb_vec3_scale(l->model->inverse_mass[i], impulse)};

	if (l->top)
		change.angular = rb_inverse_inertia_apply(l, i, orientation,
		                                          rb_vec3_cross(arm, impulse));
	return change;
}

/* Index of a body in the set; -1: a fixed one. */
static int place_of(const struct rb_located *l, int body)
{
	return body < l->n ? l->place[body] : -1;
}

static const struct rb_contact_point *point_of(const struct rb_mechanics_points *points, int k)
{
	return &points->contact_point[points->row ? points->row[k] : k];
}

static void apply_at(const struct rb_mechanics_points *points, int body, rb_vec3 arm,
                     rb_vec3 impulse)
{
	const int place = place_of(points->l, body);

	if (place < 0)
		return;
	const struct rb_mechanics_change change = rb_mechanics_change(
		points->l, body, points->pose[place].orientation, arm, impulse);

	points->linear[place] = rb_vec3_add(points->linear[place], change.linear);
	points->angular[place] = rb_vec3_add(points->angular[place], change.angular);
}

static rb_vec3 velocity_at(const struct rb_mechanics_points *points, int body, rb_vec3 arm)
{
	const int place = place_of(points->l, body);

	if (place < 0)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_add(points->linear[place], rb_vec3_cross(points->angular[place], arm));
}

void rb_mechanics_respond(const struct rb_mechanics_points *points, const rb_vec3 *impulse)
{
	for (int p = 0; p < points->body_count; p++)
		points->linear[p] = points->angular[p] = (rb_vec3){0, 0, 0};
	for (int k = 0; k < points->count; k++) {
		const struct rb_contact_point *m = point_of(points, k);

		apply_at(points, m->a, m->arm_a, rb_vec3_neg(impulse[k]));
		apply_at(points, m->b, m->arm_b, impulse[k]);
	}
}

rb_vec3 rb_mechanics_response(const struct rb_mechanics_points *points, int k)
{
	const struct rb_contact_point *m = point_of(points, k);

	return rb_vec3_sub(velocity_at(points, m->b, m->arm_b),
	                   velocity_at(points, m->a, m->arm_a));
}
