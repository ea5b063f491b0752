/* SPDX-License-Identifier: MIT */
#include "stepped/reduced_step.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "math/quat.h"

/*
 * Parts of a step, at most: they cost what rows do that are looked at as often as may be. Rounds
 * for orientations, which cost next to nothing.
 */
enum { NODES = RB_REDUCED_STEP_NODES, BEGIN = NODES, PARTS_MAX = 16, TURNS_MAX = 12 };

/* What a visit may leave of a change, lest two halves of the step cost less; and visits. */
static const double slowest = 1.0 / 8;
enum { VISITS_MAX = 18 };

/*
 * Of speeds: by so much a visit may still change them. Visits that no longer get anywhere have come
 * to rounding if they change them by less than the second, for each body.
 */
static const double close_share = DBL_EPSILON / 256, rounding_share = 1024 * DBL_EPSILON;

/*
 * Values at a part c of the step: x_0 + c h v_0 + h^2 sum_j twice_j a_j, v_0 + h sum_j once_j a_j.
 */
struct weights {
	double c, once[NODES], twice[NODES];
};

#define ROOT 3.872983346207416885 /* of 15 */
static const struct weights node[NODES + 1] = {
	{0.5 - ROOT / 10,
         {5.0 / 36, 2.0 / 9 - ROOT / 15, 5.0 / 36 - ROOT / 30},
         {1.0 / 90, 7.0 / 90 - ROOT / 45, 1.0 / 9 - ROOT / 36}},
	{0.5,
         {5.0 / 36 + ROOT / 24, 2.0 / 9, 5.0 / 36 - ROOT / 24},
         {7.0 / 144 + ROOT / 72, 1.0 / 36, 7.0 / 144 - ROOT / 72}},
	{0.5 + ROOT / 10,
         {5.0 / 36 + ROOT / 30, 2.0 / 9 + ROOT / 15, 5.0 / 36},
         {1.0 / 9 + ROOT / 36, 7.0 / 90 + ROOT / 45, 1.0 / 90}},
	{1, {5.0 / 18, 4.0 / 9, 5.0 / 18}, {5.0 / 36 + ROOT / 36, 2.0 / 9, 5.0 / 36 - ROOT / 36}},
};

/*
 * Of a node that was not visited yet, from the rates as the step begins and those of the nodes
 * before it: [visited - 1][node][beginning, nodes].
 */
static const double ahead[NODES - 1][NODES][NODES] = {
	{{0}, {-3.436491673103709, 4.436491673103709}, {-6.872983346207418, 7.872983346207418}},
	{{0}, {0}, {5.323790007724451, -7.872983346207418, 3.549193338482967}},
};

static const rb_vec3 none = {0, 0, 0};
enum { SPIN = 0, VELOCITY = 3 }; /* rates of what turns and floats */

/* ---- from coordinates to poses ---- */

static rb_vec3 added(rb_vec3 x, double h, const double *weight,
                     const struct rb_reduced_link *course, int first)
{
	for (int j = 0; j < NODES; j++)
		x = rb_vec3_add_scaled(x, h * weight[j], rb_vec3_from(course->rate[j] + first));
	return x;
}

static double speed_of(const struct rb_reduced_link *course, int way, double h,
                       const struct weights *at)
{
	double speed = 0;

	for (int j = 0; j < NODES; j++)
		speed += at->once[j] * course->rate[j][way];
	return course->speed[way] + h * speed;
}

static double way_of(const struct rb_reduced_link *course, int way, double h,
                     const struct weights *at)
{
	double sum = 0;

	for (int j = 0; j < NODES; j++)
		sum += at->twice[j] * course->rate[j][way];
	return h * (at->c * course->speed[way] + h * sum);
}

/* Orientations of what turns freely, at the nodes and the end: q' = w q / 2. */
static rb_quat turned(const struct rb_reduced_link *course, double h, const struct weights *at)
{
	rb_quat q = course->begin.orientation;

	for (int j = 0; j < NODES; j++) {
		const rb_vec3 w = rb_vec3_scale(0.5 * h * at->once[j], course->spin[j]);
		const rb_quat rate = rb_quat_multiply((rb_quat){0, w.x, w.y, w.z},
		                                      course->orientation[j]);

		q = (rb_quat){q.w + rate.w, q.x + rate.x, q.y + rate.y, q.z + rate.z};
	}
	return q;
}

/* A link where its coordinates have it, by node (or NODES: the end); its parent is there. */
static void place_link(const struct rb_reduced_step *s, int k, int at)
{
	const struct rb_joint_tree_link *const link = &s->tree.link[k];
	const struct rb_reduced_link *const course = &s->course[k];
	const struct weights *const weights = &node[at];
	const double h = s->h_s;
	struct rb_pose *const pose = &s->pose[at][link->place];

	*pose = (struct rb_pose){.orientation = course->begin.orientation};
	if (course->turns) {
		pose->orientation = at < NODES ? course->orientation[at]
		                               : turned(course, h, weights);
		pose->orientation = rb_quat_unit(pose->orientation);
		pose->spin = added(course->begin.spin, h, weights->once, course, SPIN);
	}
	if (course->floats) {
		pose->velocity = added(course->begin.velocity, h, weights->once, course, VELOCITY);
		pose->position = rb_vec3_add_scaled(course->begin.position, weights->c * h,
		                                    course->begin.velocity);
		pose->position = added(pose->position, h * h, weights->twice, course, VELOCITY);
		return;
	}
	const struct rb_pose parent = rb_joint_tree_parent(&s->tree, link, 0);
	rb_vec3 along = none, rate = none;
	int way = 0;
	double shift = 0, shift_rate = 0;

	if (link->free & RB_FREE_ALONG) {
		shift = way_of(course, way, h, weights);
		shift_rate = speed_of(course, way++, h, weights);
	}
	if (!course->turns) {
		rb_quat turn = course->turn;
		rb_vec3 spin = parent.spin;

		if (link->free & (RB_FREE_ABOUT | RB_FREE_ABOUT_BOTH)) {
			const double angle = way_of(course, way, h, weights);

			rate = rb_vec3_scale(speed_of(course, way++, h, weights), link->axis);
			turn = rb_quat_multiply(
				turn, rb_quat_from_turn(rb_vec3_scale(angle, link->axis)));
		}
		if (link->free & RB_FREE_ABOUT_BOTH) {
			const double angle = way_of(course, way, h, weights);
			const double speed = speed_of(course, way, h, weights);

			turn = rb_quat_multiply(
				rb_quat_from_turn(rb_vec3_scale(angle, link->parent_axis)), turn);
			spin = rb_vec3_add(spin,
			                   rb_quat_rotate(parent.orientation,
			                                  rb_vec3_scale(speed, link->parent_axis)));
		}
		pose->orientation = rb_quat_unit(rb_quat_multiply(parent.orientation, turn));
		pose->spin = rb_vec3_add(spin, rb_quat_rotate(pose->orientation, rate));
	}
	const rb_vec3 arm = rb_quat_rotate(pose->orientation, link->arm);
	rb_vec3 reach = rb_quat_rotate(parent.orientation, course->point);

	if (link->free & RB_FREE_ALONG) {
		along = rb_quat_rotate(pose->orientation, link->axis);
		reach = rb_vec3_add_scaled(reach, shift, along);
	}
	pose->position = rb_vec3_add(parent.position, rb_vec3_sub(reach, arm));
	pose->velocity = rb_vec3_add(parent.velocity, rb_vec3_sub(rb_vec3_cross(parent.spin, reach),
	                                                          rb_vec3_cross(pose->spin, arm)));
	pose->velocity = rb_vec3_add_scaled(pose->velocity, shift_rate, along);
}

static void place_all(struct rb_reduced_step *s, int at)
{
	s->tree.pose = s->pose[at];
	for (int k = 0; k < s->tree.count; k++)
		place_link(s, k, at);
}

/* ---- accelerations ---- */

/* N */
static rb_vec3 drag_at(const struct rb_reduced_step *s, const struct rb_pose *pose)
{
	const double speed = s->drag.quadratic > 0 ? rb_vec3_length(pose->velocity) : 0;

	return rb_vec3_scale(-(s->drag.linear + s->drag.quadratic * speed), pose->velocity);
}

/* Without joints: forces, and what turns goes on turning. */
static void accelerate_freely(const struct rb_reduced_step *s, int at, rb_vec3 *linear,
                              rb_vec3 *angular)
{
	const struct rb_model *const model = s->world->model;

	for (int k = 0; k < s->tree.count; k++) {
		const int i = s->tree.body[k];
		const rb_vec3 spin = s->pose[at][k].spin;
		const rb_quat q = s->pose[at][k].orientation;
		const double scalar = model->inverse_inertia_scalar[i];

		linear[k] = rb_vec3_add_scaled(s->force[k].force, model->inverse_mass[i],
		                               drag_at(s, &s->pose[at][k]));
		if (!isnan(scalar)) {
			angular[k] = rb_vec3_scale(scalar, s->force[k].torque);
			continue;
		}
		const rb_vec3 w = rb_quat_rotate_back(q, spin);
		const rb_vec3 torque = rb_vec3_sub(
			rb_quat_rotate_back(q, s->force[k].torque),
			rb_vec3_cross(w, rb_mat3_apply(rb_model_inertia(model, i), w)));

		angular[k] = rb_quat_rotate(
			q, rb_mat3_apply(rb_model_inverse_inertia(model, i), torque));
	}
}

/* Rates of coordinates, from accelerations at the poses. */
static void take_rates(struct rb_reduced_step *s, int at, int to)
{
	for (int k = 0; k < s->tree.count; k++) {
		const struct rb_joint_tree_link *const link = &s->tree.link[k];
		struct rb_reduced_link *const course = &s->course[k];

		for (int f = 0; f < course->ways; f++)
			course->rate[to][f] = link->freedom[f].rate;
		if (course->turns)
			rb_vec3_to(course->rate[to] + SPIN, s->angular[at][link->place]);
		if (course->floats)
			rb_vec3_to(course->rate[to] + VELOCITY, s->linear[at][link->place]);
	}
}

static void evaluate(struct rb_reduced_step *s, int at)
{
	s->tree.pose = s->pose[at];
	accelerate_freely(s, at, s->linear[at], s->angular[at]);
	rb_joint_tree_accelerate(&s->tree, 0, s->linear[at], s->angular[at]);
	s->evaluations++;
}

static double reach_of(const struct rb_reduced_step *s, int place)
{
	return rb_model_reach(s->world->model, s->tree.body[place]);
}

/* ---- a part of the step ---- */

/* Of v, in units of an axis whose length is 1 but for rounding, which must not add up. */
static double share_along(rb_vec3 v, rb_vec3 axis)
{
	return rb_vec3_dot(v, axis) / rb_vec3_dot(axis, axis);
}

/* Coordinates of a link from the poses as the part begins; its parent moves as its joints do. */
static void begin_link(struct rb_reduced_step *s, int k, const struct rb_pose *own)
{
	const struct rb_joint_tree_link *const link = &s->tree.link[k];
	struct rb_reduced_link *const course = &s->course[k];

	memset(course, 0, sizeof *course);
	course->begin = *own;
	course->floats = link->joint < 0;
	course->turns = course->floats || (link->free & RB_FREE_TURNING);
	for (int j = 0; j < NODES; j++)
		course->orientation[j] = own->orientation;
	if (course->floats)
		return;
	const struct rb_pose parent = rb_joint_tree_parent(&s->tree, link, 0);
	const rb_quat back = {parent.orientation.w, -parent.orientation.x, -parent.orientation.y,
	                      -parent.orientation.z};
	const rb_vec3 arm = rb_quat_rotate(own->orientation, link->arm);
	const rb_vec3 reach = rb_vec3_add(rb_pose_between(&parent, own), arm);
	const rb_vec3 spin = rb_vec3_sub(own->spin, parent.spin);

	course->turn = rb_quat_multiply(back, own->orientation);
	course->point = rb_quat_rotate(back, reach);
	if (link->free & RB_FREE_ALONG) {
		const rb_vec3 v = rb_vec3_sub(
			rb_vec3_add(own->velocity, rb_vec3_cross(own->spin, arm)),
			rb_vec3_add(parent.velocity, rb_vec3_cross(parent.spin, reach)));

		course->speed[course->ways++] = share_along(
			v, rb_quat_rotate(own->orientation, link->axis));
	}
	if (link->free & (RB_FREE_ABOUT | RB_FREE_ABOUT_BOTH))
		course->speed[course->ways++] = share_along(
			spin, rb_quat_rotate(own->orientation, link->axis));
	if (link->free & RB_FREE_ABOUT_BOTH)
		course->speed[course->ways++] = share_along(
			spin, rb_quat_rotate(parent.orientation, link->parent_axis));
}

/*
 * Coordinates from where the part begins (pose[BEGIN]), which is then where these have it; m/s: by
 * how much velocities are others.
 */
static double begin_part(struct rb_reduced_step *s)
{
	const double h = s->h_s;
	double off = 0;

	s->tree.pose = s->pose[BEGIN];
	s->h_s = 0;
	for (int k = 0; k < s->tree.count; k++) {
		const int place = s->tree.link[k].place;
		const struct rb_pose own = s->pose[BEGIN][place];

		begin_link(s, k, &own);
		place_link(s, k, BEGIN);
		const struct rb_pose *const is = &s->pose[BEGIN][place];
		off = fmax(off, rb_vec3_length(rb_vec3_sub(own.velocity, is->velocity)) +
		                        reach_of(s, place) *
		                                rb_vec3_length(rb_vec3_sub(own.spin, is->spin)));
	}
	s->h_s = h;
	return off;
}

/* m/s: the largest of what moves. */
static double fastest(const struct rb_reduced_step *s)
{
	double max = 0;

	for (int k = 0; k < s->tree.count; k++)
		max = fmax(max, rb_vec3_length(s->pose[BEGIN][k].velocity) +
		                        reach_of(s, k) * rb_vec3_length(s->pose[BEGIN][k].spin));
	return max;
}

/* J: kinetic energy as the step begins. */
static double energy_of(const struct rb_reduced_step *s)
{
	const struct rb_model *const model = s->world->model;
	double sum = 0;

	for (int k = 0; k < s->tree.count; k++) {
		const struct rb_pose *const pose = &s->pose[BEGIN][k];
		const int i = s->tree.body[k];

		sum += 0.5 *
		       (model->mass[i] * rb_vec3_dot(pose->velocity, pose->velocity) +
		        rb_vec3_dot(pose->spin, rb_reduced_step_weigh(model, i, pose->orientation,
		                                                      pose->spin)));
	}
	return sum;
}

/*
 * What of velocities joints do not let be is taken away, by the impulses that take the least
 * energy: those are accelerations without any motion.
 */
static void project(struct rb_reduced_step *s)
{
	struct rb_pose *const pose = s->pose[BEGIN];

	for (int k = 0; k < s->tree.count; k++) {
		s->linear[BEGIN][k] = pose[k].velocity;
		s->angular[BEGIN][k] = pose[k].spin;
		pose[k].velocity = pose[k].spin = none;
	}
	s->tree.pose = pose;
	rb_joint_tree_accelerate(&s->tree, 0, s->linear[BEGIN], s->angular[BEGIN]);
	for (int k = 0; k < s->tree.count; k++) {
		pose[k].velocity = s->linear[BEGIN][k];
		pose[k].spin = s->angular[BEGIN][k];
	}
}

/* Spins and orientations of what turns freely, at all nodes, as far as rates are known. */
static void turn_all(struct rb_reduced_step *s)
{
	for (int k = 0; k < s->tree.count; k++) {
		struct rb_reduced_link *const course = &s->course[k];
		double change = 1;

		for (int j = 0; course->turns && j < NODES; j++)
			course->spin[j] = added(course->begin.spin, s->h_s, node[j].once, course,
			                        SPIN);
		for (int turns = 0; course->turns && turns < TURNS_MAX && change > DBL_EPSILON;
		     turns++) {
			change = 0;
			for (int j = 0; j < NODES; j++) {
				const rb_quat was = course->orientation[j];
				const rb_quat q = turned(course, s->h_s, &node[j]);

				change = fmax(change,
				              fmax(fmax(fabs(q.w - was.w), fabs(q.x - was.x)),
				                   fmax(fabs(q.y - was.y), fabs(q.z - was.z))));
				course->orientation[j] = q;
			}
		}
	}
}

/* Rates at nodes that were not visited, from those that were. */
static void guess(struct rb_reduced_step *s, int visited)
{
	for (int k = 0; k < s->tree.count; k++) {
		struct rb_reduced_link *const course = &s->course[k];

		for (int i = visited; i < NODES; i++)
			for (int r = 0; r < 6; r++) {
				const double *const share = ahead[visited - 1][i];
				double sum = share[0] * course->first[r];

				for (int j = 0; j < visited; j++)
					sum += share[j + 1] * course->rate[j][r];
				course->rate[i][r] = sum;
			}
	}
}

/* m/s^2: by how much accelerations at a node have changed since they were kept; `max`: largest. */
static double changed(const struct rb_reduced_step *s, int at, double *max)
{
	double change = 0;

	for (int k = 0; k < s->tree.count; k++) {
		const double reach = reach_of(s, k);
		const rb_vec3 a = s->linear[at][k], b = s->angular[at][k];
		const rb_vec3 *const was = s->kept + 2 * k;

		*max = fmax(*max, rb_vec3_length(a) + reach * rb_vec3_length(b));
		change = fmax(change, rb_vec3_length(rb_vec3_sub(a, was[0])) +
		                              reach * rb_vec3_length(rb_vec3_sub(b, was[1])));
	}
	return change;
}

/* Visits all nodes; m/s^2: the largest change of accelerations. */
static double visit(struct rb_reduced_step *s, bool first, double *max)
{
	double change = 0;

	for (int at = 0; at < NODES; at++) {
		if (first && at > 0)
			guess(s, at);
		turn_all(s);
		place_all(s, at);
		for (int k = 0; k < s->tree.count; k++) {
			s->kept[2 * k] = s->linear[at][k];
			s->kept[2 * k + 1] = s->angular[at][k];
		}
		evaluate(s, at);
		take_rates(s, at, at);
		/* written so that NaN is a change */
		const double here = changed(s, at, max);
		change = here <= change ? change : here;
	}
	return change;
}

/* Finds the nodes; not 0: that does not converge, by what a visit leaves of a change. */
static double find_nodes(struct rb_reduced_step *s)
{
	const double speed = fastest(s);
	double was = (double)INFINITY;

	evaluate(s, BEGIN);
	for (int k = 0; k < s->tree.count; k++)
		for (int j = 0; j < NODES; j++) {
			s->linear[j][k] = s->linear[BEGIN][k];
			s->angular[j][k] = s->angular[BEGIN][k];
		}
	for (int j = 0; j < NODES; j++)
		take_rates(s, BEGIN, j);
	for (int k = 0; k < s->tree.count; k++)
		memcpy(s->course[k].first, s->course[k].rate[0], sizeof s->course[k].first);
	for (int visits = 0; visits < VISITS_MAX; visits++) {
		double max = 0;
		const double change = visit(s, visits == 0, &max);
		const double least = speed + s->h_s * max, next = s->h_s * change * (change / was);

		if (visits > 0 && next <= close_share * least)
			return 0;
		/* written so that NaN does not converge */
		if (visits > 1 && !(change < slowest * was))
			return s->h_s * change <= rounding_share * s->tree.count * least
			               ? 0
			               : change / was;
		was = change;
	}
	return slowest;
}

rb_vec3 rb_reduced_step_weigh(const struct rb_model *model, int i, rb_quat q, rb_vec3 v)
{
	if (!isnan(model->inverse_inertia_scalar[i]))
		return rb_vec3_scale(rb_model_inertia(model, i)->m[0][0], v);
	return rb_quat_rotate(q,
	                      rb_mat3_apply(rb_model_inertia(model, i), rb_quat_rotate_back(q, v)));
}

/* What joints exert at a node, from the leaves on: by link, what moves a body but forces. */
static void find_joints(struct rb_reduced_step *s, int at)
{
	const struct rb_model *const model = s->world->model;

	s->tree.pose = s->pose[at];
	accelerate_freely(s, at, s->linear[BEGIN], s->angular[BEGIN]);
	for (int k = 0; k < s->tree.count; k++) {
		const int p = s->tree.link[k].place, i = s->tree.body[p];
		const rb_vec3 a = rb_vec3_sub(s->linear[at][p], s->linear[BEGIN][p]);
		const rb_vec3 b = rb_vec3_sub(s->angular[at][p], s->angular[BEGIN][p]);

		s->on[k].force = rb_vec3_scale(model->mass[i], a);
		s->on[k].torque = rb_reduced_step_weigh(model, i, s->pose[at][p].orientation, b);
	}
	for (int k = s->tree.count; k-- > 0;) {
		const struct rb_joint_tree_link *const link = &s->tree.link[k];

		if (link->parent < 0)
			continue;
		const struct rb_pose *const parent = &s->pose[at][s->tree.link[link->parent].place];
		const rb_vec3 way = rb_pose_between(parent, &s->pose[at][link->place]);
		struct rb_wrench *const to = &s->on[link->parent];

		to->force = rb_vec3_add(to->force, s->on[k].force);
		to->torque = rb_vec3_add(
			to->torque,
			rb_vec3_add(s->on[k].torque, rb_vec3_cross(way, s->on[k].force)));
	}
}

/* The same about the point of the joint's b, on b: times `weight` to the sums. */
static void add_joints(struct rb_reduced_step *s, int at, double weight)
{
	find_joints(s, at);
	for (int k = 0; k < s->tree.count; k++) {
		const struct rb_joint_tree_link *const link = &s->tree.link[k];
		const struct rb_wrench *const on = &s->on[k];

		if (link->joint < 0)
			continue;
		const struct rb_linkage *const linkage =
			&s->world->model->joints->joint[link->joint].link;
		const struct rb_pose *const own = &s->pose[at][link->place];
		const struct rb_pose parent = rb_joint_tree_parent(&s->tree, link, 0);
		const struct rb_pose *const b = link->is_b ? own : &parent;
		const rb_vec3 from = rb_vec3_sub(rb_pose_between(b, own),
		                                 rb_quat_rotate(b->orientation, linkage->at_b));
		const rb_vec3 torque = rb_vec3_add(on->torque, rb_vec3_cross(from, on->force));
		const double share = link->is_b ? weight : -weight;

		s->sum[k].force = rb_vec3_add_scaled(s->sum[k].force, share, on->force);
		s->sum[k].torque = rb_vec3_add_scaled(s->sum[k].torque, share, torque);
	}
}

static void add_drag(struct rb_reduced_step *s, const struct rb_pose *pose, double weight,
                     int place)
{
	const rb_vec3 drag = rb_vec3_scale(weight, drag_at(s, pose));
	struct rb_wrench *const to = &s->dragged[place];

	to->force = rb_vec3_add(to->force, drag);
	to->torque = rb_vec3_add(to->torque, rb_vec3_cross(pose->position, drag));
	s->lost[place] -= rb_vec3_dot(drag, pose->velocity);
}

/* The nodes are found: sums over the step go on, and bodies to the end of the part. */
static void end_part(struct rb_reduced_step *s)
{
	for (int at = 0; at < NODES; at++) {
		const double weight = s->h_s * node[NODES].once[at];

		for (int k = 0; k < s->tree.count; k++) {
			s->place[k] = rb_vec3_add_scaled(s->place[k], weight,
			                                 s->pose[at][k].position);
			s->spin[k] = rb_vec3_add_scaled(s->spin[k], weight, s->pose[at][k].spin);
			add_drag(s, &s->pose[at][k], weight, k);
		}
		add_joints(s, at, weight);
	}
	turn_all(s);
	place_all(s, NODES);
}

/* Poses as the step begins. */
static void begin_step(struct rb_reduced_step *s)
{
	for (int k = 0; k < s->tree.count; k++)
		s->pose[BEGIN][k] = rb_world_pose(s->world, s->before, s->tree.body[k]);
	s->tree.pose = s->pose[BEGIN];
}

/* The whole step in equal parts; not 0: not so (find_nodes). */
static double take_parts(struct rb_reduced_step *s, double h, int parts)
{
	const size_t count = (size_t)s->tree.count;

	begin_step(s);
	s->taken = 0;
	memset(s->sum, 0, count * sizeof *s->sum);
	memset(s->place, 0, count * sizeof *s->place);
	memset(s->spin, 0, count * sizeof *s->spin);
	memset(s->dragged, 0, count * sizeof *s->dragged);
	memset(s->lost, 0, count * sizeof *s->lost);
	s->h_s = h / parts;
	for (int part = 0; part < parts; part++) {
		if (begin_part(s) > rounding_share * s->tree.count * fastest(s) && part == 0) {
			begin_step(s);
			s->taken = energy_of(s);
			project(s);
			(void)begin_part(s);
			s->taken -= energy_of(s);
		}
		const double leaves = find_nodes(s);

		if (leaves != 0)
			return leaves;
		end_part(s);
	}
	return 0;
}

bool rb_reduced_step_take(struct rb_reduced_step *s, double h)
{
	for (int parts = 1; parts <= PARTS_MAX; parts *= 2) {
		double leaves = take_parts(s, h, parts);

		if (leaves == 0)
			return true;
		/* written so that NaN is too many */
		for (; !(leaves <= 4 * slowest) && parts <= PARTS_MAX; parts *= 2)
			leaves /= 4;
	}
	return false;
}

double rb_reduced_step_speed(struct rb_reduced_step *s)
{
	begin_step(s);
	return fastest(s);
}

double rb_reduced_step_acceleration(struct rb_reduced_step *s)
{
	double max = 0;

	begin_step(s);
	evaluate(s, BEGIN);
	for (int k = 0; k < s->tree.count; k++)
		max = fmax(max, rb_vec3_max_abs(s->linear[BEGIN][k]) +
		                        reach_of(s, k) * rb_vec3_max_abs(s->angular[BEGIN][k]));
	return max;
}
