/* SPDX-License-Identifier: MIT */
#include "event/mechanics.h"

#include "event/pull.h"

struct rb_joint_contact rb_mechanics_contact(const struct rb_located *l, const struct rb_meet *m)
{
	const struct rb_model *model = l->model;
	const struct rb_pair_material *pair =
		&model->pair_materials[model->material[m->a] * model->material_count +
	                               model->material[m->b]];
	struct rb_joint_contact c = {.normal = m->normal,
	                             .arm_a = m->arm_a,
	                             .arm_b = m->arm_b,
	                             .friction = l->top ? pair->friction : 0,
	                             .restitution = pair->restitution};

	/* d/dt of the points' relative velocity, and of the normal that it is seen along */
	c.bias = rb_vec3_sub(rb_vec3_cross(m->pose_b.spin, m->rate_b),
	                     rb_vec3_cross(m->pose_a.spin, m->rate_a));
	c.bias = rb_vec3_add_scaled(c.bias, rb_vec3_dot(m->velocity, m->normal_rate), m->normal);
	return c;
}

rb_mat3 rb_mechanics_root(const rb_mat3 *inertia, const struct rb_top_body *top,
                          rb_quat orientation)
{
	const bool own = inertia->m[0][1] == 0 && inertia->m[0][2] == 0 && inertia->m[1][2] == 0;
	const rb_mat3 r = rb_quat_to_mat3(own ? orientation
	                                      : rb_quat_multiply(orientation, top->principal));
	const double moment[3] = {own ? inertia->m[0][0] : top->moments.x,
	                          own ? inertia->m[1][1] : top->moments.y,
	                          own ? inertia->m[2][2] : top->moments.z};
	rb_mat3 out;

	for (int k = 0; k < 3; k++)
		for (int x = 0; x < 3; x++)
			out.m[k][x] = r.m[x][k] / sqrt(moment[k]);
	return out;
}

struct rb_joint_body rb_mechanics_body(const struct rb_located *l, int i,
                                       const struct rb_pose *pose, rb_vec3 linear, rb_vec3 angular)
{
	struct rb_joint_body body = {
		.inverse_mass = l->model->inverse_mass[i], .linear = linear, .angular = angular};

	if (!l->top)
		return body;
	body.inverse_inertia = l->model->inverse_inertia_scalar[i];
	if (isnan(body.inverse_inertia))
		body.inverse_root = rb_mechanics_root(&l->model->inertia[i], &l->top_body[i],
		                                      pose->orientation);
	return body;
}

rb_vec3 rb_mechanics_turning(const struct rb_located *l, int i, double t)
{
	if (!l->top || !rb_located_on_piece(l, i))
		return (rb_vec3){0, 0, 0};
	return rb_arc_piece_rate(&l->piece[i], RB_ROW_SPIN, t);
}

struct rb_joint_body rb_mechanics_fixed(const struct rb_located *l, int i, double t)
{
	return (struct rb_joint_body){.linear = rb_arc_acceleration(l, i, t),
	                              .angular = rb_mechanics_turning(l, i, t)};
}

rb_vec3 rb_mechanics_answer(const struct rb_located *l, int i, const struct rb_pose *pose,
                            rb_vec3 arm, rb_vec3 at, rb_vec3 impulse)
{
	const rb_vec3 linear = rb_vec3_scale(l->model->inverse_mass[i], impulse);

	if (!l->top)
		return linear;
	const rb_vec3 angular = rb_pull_yield(l, i, pose->orientation, rb_vec3_cross(arm, impulse));
	return rb_vec3_add(linear, rb_vec3_cross(angular, at));
}
