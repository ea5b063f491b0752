/* SPDX-License-Identifier: MIT */
#include "located/joint_rest.h"

#include "located/follow.h"
#include "located/joint_stops.h"

bool rb_joint_rest_decide(struct rb_resolution *s)
{
	if (rb_joint_rows_drive(&s->joints)) {
		double *const multiplier = rb_slips_take(s, s->joints.count, sizeof *multiplier);

		if (!multiplier)
			return false;
		rb_joint_rows_read_problem(&s->joints, true, s->problem.joint_row, multiplier);
		rb_joint_drives_decide(&s->joints, multiplier, s->t);
	}
	rb_joint_stops_note(&s->joints, s->t);
	return s->l->status == RB_OK;
}

void rb_joint_rest_follow(struct rb_resolution *s)
{
	const struct rb_located *l = s->l;

	for (int k = 0; k < s->joints.joint_count; k++)
		if (rb_follow_moves(l, s->joints.joint[k]))
			s->constant_at_rest[l->place[rb_joint_stops_body(l, s->joints.joint[k])]] =
				false;
}

/* Cause of forces of joints with a fixed end: 0 static, 1 driven; -1: there is no such end. */
static int cause_of_support(const struct rb_resolution *s, const bool *own)
{
	const struct rb_located *l = s->l;
	int by = -1;

	for (int k = 0; k < s->joints.joint_count; k++) {
		const struct rb_joint *joint = &l->model->joints->joint[s->joints.joint[k]];
		const int end[2] = {joint->a, joint->b};

		for (int e = 0; e < 2; e++) {
			const int other = end[1 - e];

			if (other < 0 || rb_located_fixed(l, other) || !own[l->place[other]])
				continue;
			if (end[e] < 0 || end[e] >= l->n)
				by = 0;
			else if (rb_located_driven(l, end[e]) && by < 0)
				by = 1;
		}
	}
	return by;
}

/*
 * Adds the forces of springs, and of motors and friction at their bounds, on bodies of a part by
 * fixed ends: they are among its external accelerations.
 */
static void add_springs(const struct rb_resolution *s, const bool *own,
                        struct rb_account_rates *rates)
{
	const struct rb_located *l = s->l;
	struct rb_joint_spring_row spring;

	for (int k = 0; k < s->joints.joint_count; k++) {
		const struct rb_joint *joint = &l->model->joints->joint[s->joints.joint[k]];
		const struct rb_joint_row *row = &spring.row;

		if (!rb_joint_rows_spring(&s->joints, k, s->t, &spring) ||
		    (row->a >= 0 && row->b >= 0))
			continue;
		const bool on_b = row->a < 0;
		const int place = on_b ? row->b : row->a, fixed = on_b ? joint->a : joint->b;
		const int by = fixed >= 0 && rb_located_driven(l, fixed) ? 1 : 0;

		if (!own[place])
			continue;
		const rb_vec3 force = rb_vec3_scale(on_b ? spring.multiplier : -spring.multiplier,
		                                    row->wrench.linear);
		const rb_vec3 torque = rb_vec3_scale(
			spring.multiplier, on_b ? row->wrench.angular_b : row->wrench.angular_a);

		rates->force[by] = rb_vec3_add(rates->force[by], force);
		rates->torque[by][0] = rb_vec3_add(
			rates->torque[by][0],
			rb_vec3_add(torque, rb_vec3_cross(s->pose[place].position, force)));
	}
}

void rb_joint_rest_rate(const struct rb_resolution *s, const bool *own,
                        struct rb_account_rates *rates)
{
	const struct rb_located *l = s->l;
	const int by = cause_of_support(s, own);
	rb_vec3 force = rb_vec3_neg(rb_vec3_add(rates->force[0], rates->force[1]));
	rb_vec3 torque = rb_vec3_neg(rb_vec3_add(rates->torque[0][0], rates->torque[1][0]));

	if (by < 0)
		return;
	for (int k = 0; k < l->set_count; k++) {
		const int i = l->set[k];
		const struct rb_pose *pose = &s->pose[k];

		if (!own[k])
			continue;
		const rb_vec3 held = rb_vec3_scale(l->model->mass[i], s->linear[k]);

		force = rb_vec3_sub(force, held);
		torque = rb_vec3_sub(torque, rb_vec3_cross(pose->position, held));
		if (!l->top)
			continue;
		const rb_vec3 local = rb_quat_rotate_back(pose->orientation, s->angular[k]);

		torque = rb_vec3_sub(
			torque,
			rb_quat_rotate(pose->orientation,
		                       rb_mat3_apply(rb_model_inertia(l->model, i), local)));
	}
	rates->force[by] = rb_vec3_add(rates->force[by], force);
	rates->torque[by][0] = rb_vec3_add(rates->torque[by][0], torque);
	add_springs(s, own, rates);
}
