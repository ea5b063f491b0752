/* SPDX-License-Identifier: MIT */
#include "stepped/reduced_step.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "math/quat.h"

/*
 * Largest number of parts of a step: these cost as much as rows with the most passes. Iterations
 * for orientations, which are cheap.
 */
enum { NODES = RB_REDUCED_STEP_NODES, BEGIN = NODES, PARTS_MAX = 16, ORIENTATION_PASSES_MAX = 12 };

/*
 * Slowest contraction accepted per pass over the nodes, lest two halves of the step cost less; most
 * passes.
 */
static const double contraction_max = 1.0 / 8;
enum { PASSES_MAX = 18 };

/*
 * Relative to speeds: change per pass at which the iteration has converged. Passes that no longer
 * contract have reached rounding if they change speeds by less than the second, for each body.
 */
static const double close_share = DBL_EPSILON / 256, rounding_share = 1024 * DBL_EPSILON;

/*
 * Values at fraction c of the step: x_0 + c h v_0 + h^2 sum_j twice_j a_j, v_0 + h sum_j once_j
 * a_j.
 */
struct weights {
	double c, once[NODES], twice[NODES];
};

#define ROOT_15 3.872983346207416885 /* sqrt(15) */
static const struct weights node[NODES + 1] = {
	{0.5 - ROOT_15 / 10,
         {5.0 / 36, 2.0 / 9 - ROOT_15 / 15, 5.0 / 36 - ROOT_15 / 30},
         {1.0 / 90, 7.0 / 90 - ROOT_15 / 45, 1.0 / 9 - ROOT_15 / 36}},
	{0.5,
         {5.0 / 36 + ROOT_15 / 24, 2.0 / 9, 5.0 / 36 - ROOT_15 / 24},
         {7.0 / 144 + ROOT_15 / 72, 1.0 / 36, 7.0 / 144 - ROOT_15 / 72}},
	{0.5 + ROOT_15 / 10,
         {5.0 / 36 + ROOT_15 / 30, 2.0 / 9 + ROOT_15 / 15, 5.0 / 36},
         {1.0 / 9 + ROOT_15 / 36, 7.0 / 90 + ROOT_15 / 45, 1.0 / 90}},
	{1,
         {5.0 / 18, 4.0 / 9, 5.0 / 18},
         {5.0 / 36 + ROOT_15 / 36, 2.0 / 9, 5.0 / 36 - ROOT_15 / 36}},
};

/*
 * Extrapolation to nodes not evaluated yet, from the rates as the step begins and those of the
 * nodes before: [evaluated - 1][node][beginning, nodes].
 */
static const double extrapolation[NODES - 1][NODES][NODES] = {
	{{0}, {-3.436491673103709, 4.436491673103709}, {-6.872983346207418, 7.872983346207418}},
	{{0}, {0}, {5.323790007724451, -7.872983346207418, 3.549193338482967}},
};

static const rb_vec3 none = {0, 0, 0};
enum { SPIN = 0, VELOCITY = 3 }; /* offsets in `rate` of links that turn or float */

/* ---- from coordinates to poses ---- */

static rb_vec3 integrate_rate(rb_vec3 x, double h, const double *weight,
                              const struct rb_reduced_link *path, int first)
{
	for (int j = 0; j < NODES; j++)
		x = rb_vec3_add_scaled(x, h * weight[j], rb_vec3_from(path->rate[j] + first));
	return x;
}

static double speed_at(const struct rb_reduced_link *path, int coordinate, double h,
                       const struct weights *at)
{
	double speed = 0;

	for (int j = 0; j < NODES; j++)
		speed += at->once[j] * path->rate[j][coordinate];
	return path->speed[coordinate] + h * speed;
}

static double displacement_at(const struct rb_reduced_link *path, int coordinate, double h,
                              const struct weights *at)
{
	double sum = 0;

	for (int j = 0; j < NODES; j++)
		sum += at->twice[j] * path->rate[j][coordinate];
	return h * (at->c * path->speed[coordinate] + h * sum);
}

/* Orientation of a freely turning link, at the nodes and the end: q' = w q / 2. */
static rb_quat orientation_at(const struct rb_reduced_link *path, double h,
                              const struct weights *at)
{
	rb_quat q = path->begin.orientation;

	for (int j = 0; j < NODES; j++) {
		const rb_vec3 w = rb_vec3_scale(0.5 * h * at->once[j], path->spin[j]);
		const rb_quat rate = rb_quat_multiply((rb_quat){0, w.x, w.y, w.z},
		                                      path->orientation[j]);

		q = (rb_quat){q.w + rate.w, q.x + rate.x, q.y + rate.y, q.z + rate.z};
	}
	return q;
}

/* Places a link by its coordinates, at a node (or NODES: the end); its parent is placed already. */
static void place_link(const struct rb_reduced_step *s, int k, int at)
{
	const struct rb_joint_tree_link *const link = &s->tree.link[k];
	const struct rb_reduced_link *const path = &s->path[k];
	const struct weights *const weights = &node[at];
	const double h = s->h_s;
	struct rb_pose *const pose = &s->pose[at][link->place];

	*pose = (struct rb_pose){.orientation = path->begin.orientation};
	if (path->turns) {
		pose->orientation = at < NODES ? path->orientation[at]
		                               : orientation_at(path, h, weights);
		pose->orientation = rb_quat_unit(pose->orientation);
		pose->spin = integrate_rate(path->begin.spin, h, weights->once, path, SPIN);
	}
	if (path->floats) {
		pose->velocity = integrate_rate(path->begin.velocity, h, weights->once, path,
		                                VELOCITY);
		pose->position = rb_vec3_add_scaled(path->begin.position, weights->c * h,
		                                    path->begin.velocity);
		pose->position = integrate_rate(pose->position, h * h, weights->twice, path,
		                                VELOCITY);
		return;
	}
	const struct rb_pose parent = rb_joint_tree_parent(&s->tree, link, 0);
	rb_vec3 along = none, rate = none;
	int coordinate = 0;
	double shift = 0, shift_rate = 0;

	if (link->free & RB_FREE_ALONG) {
		shift = displacement_at(path, coordinate, h, weights);
		shift_rate = speed_at(path, coordinate++, h, weights);
	}
	if (!path->turns) {
		rb_quat turn = path->turn;
		rb_vec3 spin = parent.spin;

		if (link->free & (RB_FREE_ABOUT | RB_FREE_ABOUT_BOTH)) {
			const double angle = displacement_at(path, coordinate, h, weights);

			rate = rb_vec3_scale(speed_at(path, coordinate++, h, weights), link->axis);
			turn = rb_quat_multiply(
				turn, rb_quat_from_turn(rb_vec3_scale(angle, link->axis)));
		}
		if (link->free & RB_FREE_ABOUT_BOTH) {
			const double angle = displacement_at(path, coordinate, h, weights);
			const double speed = speed_at(path, coordinate, h, weights);

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
	rb_vec3 reach = rb_quat_rotate(parent.orientation, path->point);

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

/* Accelerations without joints: forces and gyroscopic terms. */
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

/* Stores second rates of coordinates, from accelerations at the poses. */
static void take_rates(struct rb_reduced_step *s, int at, int to)
{
	for (int k = 0; k < s->tree.count; k++) {
		const struct rb_joint_tree_link *const link = &s->tree.link[k];
		struct rb_reduced_link *const path = &s->path[k];

		for (int f = 0; f < path->coordinate_count; f++)
			path->rate[to][f] = link->freedom[f].rate;
		if (path->turns)
			rb_vec3_to(path->rate[to] + SPIN, s->angular[at][link->place]);
		if (path->floats)
			rb_vec3_to(path->rate[to] + VELOCITY, s->linear[at][link->place]);
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

/* Component of v along an axis whose length is 1 but for rounding, which must not add up. */
static double share_along(rb_vec3 v, rb_vec3 axis)
{
	return rb_vec3_dot(v, axis) / rb_vec3_dot(axis, axis);
}

/*
 * Coordinates of a link from the poses as the part begins; its parent already moves as its joints
 * allow.
 */
static void begin_link(struct rb_reduced_step *s, int k, const struct rb_pose *own)
{
	const struct rb_joint_tree_link *const link = &s->tree.link[k];
	struct rb_reduced_link *const path = &s->path[k];

	memset(path, 0, sizeof *path);
	path->begin = *own;
	path->floats = link->joint < 0;
	path->turns = path->floats || (link->free & RB_FREE_TURNING);
	for (int j = 0; j < NODES; j++)
		path->orientation[j] = own->orientation;
	if (path->floats)
		return;
	const struct rb_pose parent = rb_joint_tree_parent(&s->tree, link, 0);
	const rb_quat back = {parent.orientation.w, -parent.orientation.x, -parent.orientation.y,
	                      -parent.orientation.z};
	const rb_vec3 arm = rb_quat_rotate(own->orientation, link->arm);
	const rb_vec3 reach = rb_vec3_add(rb_pose_between(&parent, own), arm);
	const rb_vec3 spin = rb_vec3_sub(own->spin, parent.spin);

	path->turn = rb_quat_multiply(back, own->orientation);
	path->point = rb_quat_rotate(back, reach);
	if (link->free & RB_FREE_ALONG) {
		const rb_vec3 v = rb_vec3_sub(
			rb_vec3_add(own->velocity, rb_vec3_cross(own->spin, arm)),
			rb_vec3_add(parent.velocity, rb_vec3_cross(parent.spin, reach)));

		path->speed[path->coordinate_count++] = share_along(
			v, rb_quat_rotate(own->orientation, link->axis));
	}
	if (link->free & (RB_FREE_ABOUT | RB_FREE_ABOUT_BOTH))
		path->speed[path->coordinate_count++] = share_along(
			spin, rb_quat_rotate(own->orientation, link->axis));
	if (link->free & RB_FREE_ABOUT_BOTH)
		path->speed[path->coordinate_count++] = share_along(
			spin, rb_quat_rotate(parent.orientation, link->parent_axis));
}

/*
 * Coordinates from the poses at the beginning of the part (pose[BEGIN]), which are then replaced by
 * those of the coordinates; m/s: largest change of velocity by that.
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
		const struct rb_pose *const placed = &s->pose[BEGIN][place];
		off = fmax(off, rb_vec3_length(rb_vec3_sub(own.velocity, placed->velocity)) +
		                        reach_of(s, place) * rb_vec3_length(rb_vec3_sub(
								     own.spin, placed->spin)));
	}
	s->h_s = h;
	return off;
}

/* m/s: largest speed of a point of the bodies. */
static double speed_max(const struct rb_reduced_step *s)
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
		        rb_vec3_dot(pose->spin, rb_reduced_step_times_inertia(
							model, i, pose->orientation, pose->spin)));
	}
	return sum;
}

/*
 * Removes the velocities that violate joints, by the impulses that dissipate the least energy:
 * computed as accelerations at zero velocity.
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

/* Spins and orientations of freely turning links, at all nodes, with the present rates. */
static void turn_all(struct rb_reduced_step *s)
{
	for (int k = 0; k < s->tree.count; k++) {
		struct rb_reduced_link *const path = &s->path[k];
		double change = 1;

		for (int j = 0; path->turns && j < NODES; j++)
			path->spin[j] = integrate_rate(path->begin.spin, s->h_s, node[j].once, path,
			                               SPIN);
		for (int turns = 0;
		     path->turns && turns < ORIENTATION_PASSES_MAX && change > DBL_EPSILON;
		     turns++) {
			change = 0;
			for (int j = 0; j < NODES; j++) {
				const rb_quat previous = path->orientation[j];
				const rb_quat q = orientation_at(path, s->h_s, &node[j]);

				change = fmax(
					change,
					fmax(fmax(fabs(q.w - previous.w), fabs(q.x - previous.x)),
				             fmax(fabs(q.y - previous.y), fabs(q.z - previous.z))));
				path->orientation[j] = q;
			}
		}
	}
}

/* Extrapolates rates to nodes not evaluated yet. */
static void extrapolate(struct rb_reduced_step *s, int evaluated)
{
	for (int k = 0; k < s->tree.count; k++) {
		struct rb_reduced_link *const path = &s->path[k];

		for (int i = evaluated; i < NODES; i++)
			for (int r = 0; r < 6; r++) {
				const double *const share = extrapolation[evaluated - 1][i];
				double sum = share[0] * path->first[r];

				for (int j = 0; j < evaluated; j++)
					sum += share[j + 1] * path->rate[j][r];
				path->rate[i][r] = sum;
			}
	}
}

/*
 * m/s^2: largest change of accelerations at a node since they were kept; `max`: largest
 * acceleration.
 */
static double acceleration_change(const struct rb_reduced_step *s, int at, double *max)
{
	double change = 0;

	for (int k = 0; k < s->tree.count; k++) {
		const double reach = reach_of(s, k);
		const rb_vec3 a = s->linear[at][k], b = s->angular[at][k];
		const rb_vec3 *const previous = s->kept + 2 * k;

		*max = fmax(*max, rb_vec3_length(a) + reach * rb_vec3_length(b));
		change = fmax(change, rb_vec3_length(rb_vec3_sub(a, previous[0])) +
		                              reach * rb_vec3_length(rb_vec3_sub(b, previous[1])));
	}
	return change;
}

/* Evaluates all nodes once; m/s^2: largest change of accelerations. */
static double evaluate_nodes(struct rb_reduced_step *s, bool first, double *max)
{
	double change = 0;

	for (int at = 0; at < NODES; at++) {
		if (first && at > 0)
			extrapolate(s, at);
		turn_all(s);
		place_all(s, at);
		for (int k = 0; k < s->tree.count; k++) {
			s->kept[2 * k] = s->linear[at][k];
			s->kept[2 * k + 1] = s->angular[at][k];
		}
		evaluate(s, at);
		take_rates(s, at, at);
		/* written so that NaN is a change */
		const double here = acceleration_change(s, at, max);
		change = here <= change ? change : here;
	}
	return change;
}

/* Iterates the nodes; not 0: no convergence, the last contraction factor. */
static double find_nodes(struct rb_reduced_step *s)
{
	const double speed = speed_max(s);
	double previous = (double)INFINITY;

	evaluate(s, BEGIN);
	for (int k = 0; k < s->tree.count; k++)
		for (int j = 0; j < NODES; j++) {
			s->linear[j][k] = s->linear[BEGIN][k];
			s->angular[j][k] = s->angular[BEGIN][k];
		}
	for (int j = 0; j < NODES; j++)
		take_rates(s, BEGIN, j);
	for (int k = 0; k < s->tree.count; k++)
		memcpy(s->path[k].first, s->path[k].rate[0], sizeof s->path[k].first);
	for (int passes = 0; passes < PASSES_MAX; passes++) {
		double max = 0;
		const double change = evaluate_nodes(s, passes == 0, &max);
		const double least = speed + s->h_s * max,
			     next = s->h_s * change * (change / previous);

		if (passes > 0 && next <= close_share * least)
			return 0;
		/* written so that NaN does not converge */
		if (passes > 1 && !(change < contraction_max * previous))
			return s->h_s * change <= rounding_share * s->tree.count * least
			               ? 0
			               : change / previous;
		previous = change;
	}
	return contraction_max;
}

rb_vec3 rb_reduced_step_times_inertia(const struct rb_model *model, int i, rb_quat q, rb_vec3 v)
{
	if (!isnan(model->inverse_inertia_scalar[i]))
		return rb_vec3_scale(rb_model_inertia(model, i)->m[0][0], v);
	return rb_quat_rotate(q,
	                      rb_mat3_apply(rb_model_inertia(model, i), rb_quat_rotate_back(q, v)));
}

/* Loads of joints at a node, from the leaves on: by link, inertial force minus external force. */
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
		s->on[k].torque = rb_reduced_step_times_inertia(model, i,
		                                                s->pose[at][p].orientation, b);
	}
	for (int k = s->tree.count; k-- > 0;) {
		const struct rb_joint_tree_link *const link = &s->tree.link[k];

		if (link->parent < 0)
			continue;
		const struct rb_pose *const parent = &s->pose[at][s->tree.link[link->parent].place];
		const rb_vec3 arm = rb_pose_between(parent, &s->pose[at][link->place]);
		struct rb_wrench *const to = &s->on[link->parent];

		to->force = rb_vec3_add(to->force, s->on[k].force);
		to->torque = rb_vec3_add(
			to->torque,
			rb_vec3_add(s->on[k].torque, rb_vec3_cross(arm, s->on[k].force)));
	}
}

/* Adds them, about the joint's point of b and acting on b, times `weight` to the sums. */
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

/* After the iteration: adds to the sums over the step, and moves bodies to the end of the part. */
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

/* Takes the whole step in equal parts; not 0: no convergence (find_nodes). */
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
		if (begin_part(s) > rounding_share * s->tree.count * speed_max(s) && part == 0) {
			begin_step(s);
			s->taken = energy_of(s);
			project(s);
			(void)begin_part(s);
			s->taken -= energy_of(s);
		}
		const double contraction = find_nodes(s);

		if (contraction != 0)
			return contraction;
		end_part(s);
	}
	return 0;
}

bool rb_reduced_step_take(struct rb_reduced_step *s, double h)
{
	for (int parts = 1; parts <= PARTS_MAX; parts *= 2) {
		double contraction = take_parts(s, h, parts);

		if (contraction == 0)
			return true;
		/* written so that NaN is too many */
		for (; !(contraction <= 4 * contraction_max) && parts <= PARTS_MAX; parts *= 2)
			contraction /= 4;
	}
	return false;
}

double rb_reduced_step_speed(struct rb_reduced_step *s)
{
	begin_step(s);
	return speed_max(s);
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
