/* SPDX-License-Identifier: MIT */
/*
 * Scales of errors for the integrator, and the first step length. The rounding of a stack is that
 * of its loads, not of their small differences: a smaller error would require ever shorter steps.
 */
#include "located/piece_scales.h"

#include "force/spring.h"
#include "located/external_force.h"

/*
 * Rounding is a few ulp of an angle or a length, the integrator's tolerance 16 times as many.
 * Otherwise damped motion would take ever shorter pieces as it comes to rest.
 */
static const double spring_share = 0x1p-4;

/* Acceleration, m/s^2, that the force alone would give to the body's point. */
static double load_of(const struct rb_modes *w, int body, rb_vec3 arm, rb_vec3 force)
{
	const int place = rb_modes_place(w, body);

	if (place < 0)
		return 0;
	const double linear = w->l->model->inverse_mass[body] * rb_vec3_length(force);
	const rb_vec3 total = rb_mechanics_point_response(w->l, body, &w->pose[place], arm, arm,
	                                                  force);

	return fmax(linear, rb_vec3_length(total));
}

/* Size of the body, or of its joints if larger, m. */
static double size_of(const struct rb_modes *w, int body)
{
	const struct rb_joints *joints = w->l->model->joints;
	double size = rb_model_reach(w->l->model, body);

	for (int e = joints ? joints->first[body] : 0; joints && e < joints->first[body + 1]; e++)
		size = fmax(size, joints->joint[joints->of[e]].size);
	return size;
}

/*
 * Accelerations of points of a rotating jointed body, m/s^2: those of its joints, and the
 * reactions, are differences of these, and round like them where they cancel, as in a balanced
 * wheel in gimbals. Includes the torque of a motor at its bound, which has no row.
 */
static double turning_load(const struct rb_modes *w, int k)
{
	const double spin = rb_vec3_length(w->pose[k].spin);
	const double angular = fmax(spin * spin, rb_vec3_length(w->angular[k]));

	return angular * size_of(w, w->c->member[k]);
}

/*
 * Acceleration of a member's points by a joint's row with that multiplier, m/s^2. For a couple
 * alone, such as a stop or motor on the body's own axis, by the rotation.
 */
static double row_load(const struct rb_modes *w, int place, rb_vec3 linear, rb_vec3 angular,
                       double multiplier)
{
	if (place < 0)
		return 0;
	const int body = w->c->member[place];
	const double acceleration = w->l->model->inverse_mass[body] * rb_vec3_length(linear);

	if (acceleration > 0 || !w->l->top)
		return acceleration * multiplier;
	return multiplier * size_of(w, body) *
	       rb_vec3_length(
		       rb_inverse_inertia_apply(w->l, body, w->pose[place].orientation, angular));
}

/* Largest load of a member. Forces solved together have the rounding of the largest. */
double rb_piece_scales_load(const struct rb_modes *w)
{
	double max = 0;

	for (int k = 0; k < w->c->held_count; k++) {
		const struct rb_held *held = &w->c->held[k];

		max = fmax(max, load_of(w, held->a, w->contact_point[k].arm_a, w->force[k]));
		max = fmax(max, load_of(w, held->b, w->contact_point[k].arm_b, w->force[k]));
	}
	for (int k = 0; k < w->joints.count; k++) {
		const struct rb_joint_row *row = &w->joints.row[k];
		const double size = fabs(w->multiplier[k]);

		max = fmax(max,
		           row_load(w, row->a, row->wrench.linear, row->wrench.angular_a, size));
		max = fmax(max,
		           row_load(w, row->b, row->wrench.linear, row->wrench.angular_b, size));
	}
	for (int k = 0; w->joints.count > 0 && k < w->c->member_count; k++)
		if (rb_joint_rows_hold(w->l, w->c->member[k]))
			max = fmax(max, turning_load(w, k));
	return max;
}

/*
 * Acceleration of a member's points to which the rounding of joints' springs is relative, even
 * where they exert no force, m/s^2: their torque for a turn of 1 rad, or their force for an
 * extension by the joint's size.
 */
static double joint_spring_load(const struct rb_modes *w)
{
	struct rb_joint_spring_row spring;
	double max = 0;

	for (int k = 0; k < w->joints.joint_count && w->joints.sprung; k++) {
		const struct rb_joint *joint = &w->l->model->joints->joint[w->joints.joint[k]];
		const struct rb_joint_row *const row = &spring.row;

		if (!(joint->stiffness > 0) ||
		    !rb_joint_rows_spring(&w->joints, k, w->origin_s, &spring))
			continue;
		const double total = joint->stiffness *
		                     (rb_linkage_turns(&joint->link) ? 1 : joint->size);

		max = fmax(max,
		           row_load(w, row->a, row->wrench.linear, row->wrench.angular_a, total));
		max = fmax(max,
		           row_load(w, row->b, row->wrench.linear, row->wrench.angular_b, total));
	}
	return max;
}

/* The same for springs between bodies, by their lengths. */
static double spring_load(const struct rb_modes *w)
{
	const struct rb_model *model = w->l->model;
	const struct rb_elements *springs = rb_model_elements(model, &rb_force_spring);
	double max = joint_spring_load(w);

	for (int k = 0; springs && k < w->c->member_count; k++) {
		const int i = w->c->member[k];

		for (int m = springs->first[i]; m < springs->first[i + 1]; m++) {
			const struct rb_spring_def *spring = rb_elements_row(springs,
			                                                     springs->of[m]);
			const double length = fmax(spring->rest_length_m, rb_model_reach(model, i));

			max = fmax(max, model->inverse_mass[i] * spring->stiffness * length);
		}
	}
	return max;
}

/*
 * Speed below which a member's speed is rounding, m/s: where forces balance, it is by rounding of
 * the forces over a piece, and at most that of a fall by its own size.
 */
static double balanced(const struct rb_modes *w, double load, double radius)
{
	const double fall = sqrt(load * radius), try_s = w->c->try_s;

	return try_s > 0 ? fmin(fall, load * try_s / 8) : fall;
}

/* Length over which gravitation curves a member's path, m, if that is more than its own size. */
static double curvature_length(const struct rb_modes *w, int k)
{
	const struct rb_located *l = w->l;
	double depth;

	if (!rb_located_gravitates(l) || !rb_gravitation_attracts(l->model, w->c->member[k]))
		return 0;
	return rb_attract_distance(&l->gravitation.all, w->c->member[k], &depth);
}

double rb_piece_scales_fall(const struct rb_modes *w)
{
	const double load = rb_piece_scales_load(w);
	double least = HUGE_VAL;

	for (int k = 0; load > 0 && k < w->c->member_count; k++)
		least = fmin(least, sqrt(rb_model_reach(w->l->model, w->c->member[k]) / load));
	return least;
}

double rb_piece_scales_of(struct rb_modes *w, double *scale)
{
	const struct rb_located *l = w->l;
	const double load = fmax(rb_piece_scales_load(w), spring_share * spring_load(w));
	double try_s = l->end_s;

	for (int k = 0; k < w->c->member_count; k++) {
		const struct rb_pose *pose = &w->pose[k];
		const double radius = fmax(size_of(w, w->c->member[k]), curvature_length(w, k));
		const double external = rb_vec3_length(w->linear[k]);
		const double own = fmax(rb_vec3_length(pose->velocity), sqrt(external * radius));
		const double speed = fmax(own, balanced(w, load, radius));
		const double spin = fmax(rb_vec3_length(pose->spin), speed / radius);
		double *const s = scale + (size_t)k * (size_t)w->row;

		for (int m = 0; m < 3; m++) {
			/* over a long path, the rounding of that */
			s[RB_PIECE_POSITION + m] = fmax(radius, speed * w->c->try_s / 32);
			s[RB_PIECE_VELOCITY + m] = speed > 0 ? speed : radius / l->end_s;
		}
		for (int m = RB_PIECE_ORIENTATION; l->top && m < RB_PIECE_SPIN; m++)
			s[m] = 1;
		for (int m = 0; l->top && m < 3; m++)
			s[RB_PIECE_SPIN + m] = spin > 0 ? spin : 1 / l->end_s;
		if (own > 0)
			try_s = fmin(try_s, radius / own);
	}
	return try_s;
}
