/* SPDX-License-Identifier: MIT */
#include "located/rest_rates.h"

#include "math/attract.h"

void rb_rest_rates_contact(const struct rb_resolution *s, int k, bool rest_speed,
                           struct rb_account_rates *rates)
{
	const struct rb_contact_point *m = &s->contact_point[k];
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const bool b_moves = rb_located_fixed(s->l, m->a);
	const int mover = b_moves ? c->b : c->a, fixed = b_moves ? m->a : m->b;

	if (!rb_located_fixed(s->l, fixed))
		return;
	const struct rb_solver_body *body = &s->problem.body[mover];
	const struct rb_pose *pose = &s->pose[mover];
	const rb_vec3 arm = b_moves ? m->arm_b : m->arm_a;
	const rb_vec3 force = b_moves ? c->impulse : rb_vec3_neg(c->impulse);
	const int by = rb_located_driven(s->l, fixed) ? 1 : 0;
	rb_vec3 *const torque = rates->torque[by];

	rates->force[by] = rb_vec3_add(rates->force[by], force);
	torque[0] = rb_vec3_add(torque[0], rb_vec3_cross(rb_vec3_add(pose->position, arm), force));
	if (rest_speed)
		return;
	rates->sliding[0] -= rb_vec3_dot(
		force, rb_vec3_add(pose->velocity, rb_vec3_cross(pose->spin, arm)));
	rates->sliding[1] -= rb_vec3_dot(
		force, rb_vec3_add(body->linear, rb_vec3_cross(body->angular, arm)));
	torque[1] = rb_vec3_add(torque[1], rb_vec3_cross(pose->velocity, force));
	torque[2] = rb_vec3_add_scaled(torque[2], 0.5, rb_vec3_cross(body->linear, force));
}

void rb_rest_rates_centers(const struct rb_resolution *s, int member,
                           struct rb_account_rates *rates)
{
	const struct rb_located *l = s->l;
	const struct rb_attract *const all = &l->gravitation.all;

	for (int j = l->n; rb_located_gravitates(l) && j < all->count; j++) {
		double factor;
		const rb_vec3 d = rb_attract_between(all, member, j, &factor);
		const rb_vec3 on = rb_vec3_scale(factor * all->inertial[member] * all->mu[j], d);

		rates->force[0] = rb_vec3_add(rates->force[0], on);
		rates->torque[0][0] = rb_vec3_add(
			rates->torque[0][0],
			rb_vec3_cross(rb_gravitation_position(&l->gravitation, member), on));
	}
}
