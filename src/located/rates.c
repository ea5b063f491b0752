/* SPDX-License-Identifier: MIT */
/*
 * Right-hand side of a cluster's differential equation for math/gauss: poses from values, external
 * accelerations, contact points, forces by the modes, accelerations. Every evaluation counts its
 * multiplications, so that clusters too large for this method are left to the stepped one.
 */
#include "located/rates.h"

#include <float.h>
#include <string.h>

#include "located/account.h"
#include "located/articulated.h"
#include "located/external_force.h"
#include "located/event_set.h"
#include "located/work.h"

/* Largest relative error attributed to rounding of positions. */
static const double rounding_error_max = 1e-6;

/*
 * Share of the external accelerations below which accelerations are residuals of the solver: of a
 * cluster at rest, and of a sliding one.
 */
static const double rest_share = 1e-12, rounding_share = 16 * DBL_EPSILON;

/* Pose of member k from the integrator's values. */
static void read_pose(struct rb_modes *w, int k, const double *value)
{
	const struct rb_located *l = w->l;
	const int i = w->c->member[k];
	const double *v = value + (size_t)k * (size_t)w->row;
	struct rb_pose *pose = &w->pose[k];
	const rb_vec3 base = w->base[k], offset = rb_vec3_from(v + RB_PIECE_POSITION);

	pose->position = rb_vec3_add(base, offset);
	pose->rest = rb_vec3_lost(base, offset, pose->position);
	pose->velocity = rb_vec3_from(v + RB_PIECE_VELOCITY);
	if (l->top) {
		pose->orientation = rb_quat_unit(rb_quat_from(v + RB_PIECE_ORIENTATION));
		pose->spin = rb_vec3_from(v + RB_PIECE_SPIN);
	} else {
		pose->spin = (rb_vec3){0, 0, 0};
		pose->orientation = l->model->orientation[i];
	}
	pose->origin = pose->position;
	if (l->model->center_of_mass)
		pose->origin = rb_vec3_sub(
			pose->position,
			rb_quat_rotate(pose->orientation, l->model->center_of_mass[i]));
}

/*
 * Zeroes accelerations that are rounding. In a cluster at rest the sum of forces has a rounding
 * error, which must not accumulate over many evaluations; in a sliding one it would grow.
 */
static void zero_rounding(struct rb_modes *w, double external)
{
	bool sleeps = true;

	for (int k = 0; k < w->c->member_count; k++)
		sleeps = sleeps && rb_vec3_max_abs(w->pose[k].velocity) == 0;
	const double max = external * (sleeps ? rest_share : rounding_share);
	for (int k = 0; k < w->c->member_count; k++) {
		const double radius = rb_model_reach(w->l->model, w->c->member[k]);

		if (rb_vec3_max_abs(w->pose[k].spin) > 0 || rb_vec3_max_abs(w->linear[k]) > max ||
		    rb_vec3_max_abs(w->angular[k]) * radius > max)
			return;
	}
	for (int k = 0; k < w->c->member_count; k++)
		w->linear[k] = w->angular[k] = (rb_vec3){0, 0, 0};
}

bool rb_rates_external(struct rb_modes *w, double t, double *max)
{
	struct rb_located *l = w->l;
	const struct rb_force_query view = {.pose = w->pose,
	                                    .time_s = t,
	                                    .active_s = w->origin_s,
	                                    .parts = w->parts,
	                                    .attracted = true};

	rb_external_attract(l, &view);
	const bool attracts = !w->parts && rb_external_is_attraction(l);
	for (int k = 0; k < w->c->member_count; k++) {
		if (!attracts) {
			rb_external_force_at(l, w->c->member[k], &w->pose[k], &view, &w->linear[k],
			                     &w->angular[k]);
			continue;
		}
		w->linear[k] = rb_vec3_add(l->model->scene->world.gravity,
		                           rb_gravitation_found(&l->gravitation, w->c->member[k]));
		w->angular[k] = (rb_vec3){0, 0, 0};
	}
	if (w->joints.joint_count > 0)
		rb_joint_rows_add_springs(&w->joints, t, w->linear, w->angular);
	if (!max)
		return l->status == RB_OK;
	*max = 0;
	for (int k = 0; k < w->c->member_count; k++)
		*max = fmax(*max, rb_vec3_max_abs(w->linear[k]));
	return l->status == RB_OK;
}

/*
 * Scale of accelerations, m/s^2: of members' surfaces by external forces, and of the contacts'
 * biases.
 */
static double largest_acceleration(const struct rb_modes *w)
{
	double max = 0;

	for (int k = 0; k < w->c->member_count; k++)
		max = fmax(max, rb_vec3_length(w->linear[k]) +
		                        rb_vec3_length(w->angular[k]) *
		                                w->l->model->shape[w->c->member[k]].radius);
	for (int k = 0; k < w->c->held_count; k++)
		max = fmax(max, rb_vec3_length(w->contact[k].bias));
	for (int k = 0; k < w->joints.count; k++)
		max = fmax(max, fabs(w->joints.row[k].bias));
	return max;
}

/* Counts the cost of an evaluation of moving members; false: it is too much. */
static bool count_inspection(struct rb_modes *w)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;

	/*
	 * a piece after one that was not cut is as long as the motion allows: this is not a crowd
	 */
	if (rb_located_gravitates(l) && w->goes_on)
		return true;
	if (!rb_modes_move(w))
		return true;
	if (rb_located_gravitates(l))
		l->products += RB_LOCATED_ATTRACTION * (uint64_t)c->member_count *
		               (uint64_t)c->member_count / 2;
	/* an elimination does four products at a time */
	l->products += c->held_count + w->joints.count > 0
	                       ? (uint64_t)w->dense.products / 2 +
	                                 RB_LOCATED_INSPECTION *
	                                         (uint64_t)(c->held_count + w->joints.joint_count)
	                       : RB_LOCATED_FLIGHT * (uint64_t)c->member_count;
	if (rb_located_is_dense(l))
		l->status = c->held_count > 0
		                    ? RB_FAIL(l->err, RB_ERR_PHYSICS,
		                              "%d contacts together are too many to locate",
		                              c->held_count)
		                    : RB_FAIL(l->err, RB_ERR_PHYSICS,
		                              "%d bodies together move too fast to locate",
		                              c->member_count);
	return l->status == RB_OK;
}

void rb_rates_poses(struct rb_modes *w, const double *value)
{
	for (int k = 0; k < w->c->member_count; k++)
		read_pose(w, k, value);
}

/* Work of an evaluation, in multiplications: per body, and of an elimination. */
static uint64_t work_of(const struct rb_modes *w)
{
	enum { BODY_WORK = 256 };
	const uint64_t n = (uint64_t)w->dense.n;

	return BODY_WORK * (uint64_t)w->c->member_count + n * n * n / 3;
}

bool rb_rates_are_stopped(struct rb_modes *w)
{
	struct rb_located *l = w->l;

	/* queries for accelerations, as by `check`, are no run that could be stopped */
	if (!l->err)
		return false;
	if (l->status == RB_OK && rb_interrupt_after(&l->world->interrupt, work_of(w)))
		l->status = RB_FAIL(l->err, RB_ERR_INTERRUPT, "interrupted");
	return l->status == RB_ERR_INTERRUPT;
}

/*
 * Speed below which a slip of this contact is rounding, and keeps the direction in which it began,
 * m/s. Where friction jams, the relative change of the normal force is the error of the direction
 * times the friction coefficient.
 */
static double direction_speed(const struct rb_modes *w, int k)
{
	return 4 * rb_contact_point_noise(w->l, &w->contact_point[k]) *
	       fmax(1, w->c->held[k].friction);
}

/* Poses, forces of contacts and accelerations at `t`. */
bool rb_rates_evaluate(struct rb_modes *w, double t, const double *value)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;
	const bool is_free = c->held_count == 0 && w->joints.joint_count == 0;
	double external;

	w->time_s = t;
	rb_rates_poses(w, value);
	if (w->singular.projects && !rb_joint_rows_project(&w->joints, t, w->pose))
		return false;
	if (!rb_rates_external(w, t, is_free ? NULL : &external))
		return false;
	if (is_free)
		return count_inspection(w);
	for (int k = 0; k < c->held_count; k++) {
		const struct rb_held *held = &c->held[k];
		const int a = rb_modes_place(w, held->a), b = rb_modes_place(w, held->b);
		const struct rb_pose pose_a = a >= 0 ? w->pose[a] : rb_arc_pose(l, held->a, t);
		const struct rb_pose pose_b = b >= 0 ? w->pose[b] : rb_arc_pose(l, held->b, t);

		if (rb_event_set_is_single(l, held->a, held->b)) {
			w->contact_point[k] = rb_contact_point_poses(l, held->a, held->b, &pose_a,
			                                             &pose_b);
		} else {
			const struct rb_contact_name name = rb_event_set_name(held);

			w->contact_point[k] = rb_contact_point_of(l, &name, &pose_a, &pose_b);
		}
		w->contact[k] = rb_mechanics_contact(l, &w->contact_point[k]);
		if (held->slipping)
			w->contact[k].friction = held->friction;
		/* a kept direction turns with the normal */
		const rb_vec3 direction = rb_vec3_max_abs(held->common) > 0 ? held->common
		                                                            : held->slip;
		w->contact[k].slip = rb_vec3_unit(
			rb_vec3_reject(direction, w->contact_point[k].normal), direction);
		if (held->slipping && !held->straight && !held->creeps) {
			const rb_vec3 slip = rb_vec3_reject(w->contact_point[k].velocity,
			                                    w->contact_point[k].normal);
			const double speed = rb_vec3_length(slip);

			if (speed > direction_speed(w, k))
				w->contact[k].slip = rb_vec3_scale(1 / speed, slip);
		}
	}
	rb_joint_rows_fill(&w->joints, t);
	w->max = largest_acceleration(w);
	if (c->held_count == 0 && w->joints.count == 0)
		return count_inspection(w);
	const bool solved = rb_modes_solve(w, t);
	if (!solved && !rb_modes_solve_any(w, t, NULL))
		return false;
	if (!rb_modes_press(w, w->force, w->multiplier) || (solved && !rb_modes_refine(w, t)))
		return false;
	if (solved && w->joints.count > 0 &&
	    !rb_coupled_accept(&w->coupled, &w->dense, t, w->unknown, w->residual,
	                       DBL_EPSILON * w->max))
		return rb_rates_evaluate(w, t, value);
	zero_rounding(w, external);
	return count_inspection(w);
}

/* The same, by trees of joints. */
static bool evaluate_trees(struct rb_modes *w, double t, const double *value)
{
	double external;

	w->time_s = t;
	rb_rates_poses(w, value);
	if (!rb_rates_external(w, t, &external))
		return false;
	rb_joint_tree_accelerate(w->articulated, t, w->linear, w->angular);
	zero_rounding(w, external);
	return count_inspection(w);
}

/* Difference from the known accelerations, relative to scale: the rounding of both, 1/s. */
static double noise_of(const struct rb_modes *w, const rb_vec3 *known)
{
	double max = 0;

	for (int k = 0; k < w->c->member_count; k++) {
		const double *const scale = w->scale + (size_t)k * (size_t)w->row;
		const rb_vec3 a = rb_vec3_sub(w->linear[k], known[2 * k]);
		const rb_vec3 b = rb_vec3_sub(w->angular[k], known[2 * k + 1]);

		max = fmax(max, fmax(rb_vec3_max_abs(a) / scale[RB_PIECE_VELOCITY],
		                     rb_vec3_max_abs(b) / scale[RB_PIECE_SPIN]));
	}
	return max;
}

bool rb_rates_take_trees(struct rb_modes *w, const double *value, double *noise)
{
	const size_t count = (size_t)w->c->member_count;
	rb_vec3 *const known = rb_arena_take(w->l->arena, 2 * count, sizeof *known);
	const uint64_t products = w->l->products;

	if (!known)
		return false;
	if (w->c->held_count == 0 && !rb_articulated_take(&w->joints, &w->articulated))
		return false;
	if (!w->articulated)
		return true;
	for (size_t k = 0; k < count; k++) {
		known[2 * k] = w->linear[k];
		known[2 * k + 1] = w->angular[k];
	}
	if (!evaluate_trees(w, w->origin_s, value))
		return false;
	if (!rb_articulated_agrees(&w->joints, w->max, w->linear, w->angular, known))
		w->articulated = NULL;
	*noise = w->articulated ? noise_of(w, known) : 0;
	w->l->products = products; /* a trial must not change decisions */
	for (size_t k = 0; k < count; k++) {
		w->linear[k] = known[2 * k];
		w->angular[k] = known[2 * k + 1];
	}
	return true;
}

void rb_rates_turning(void *user, const double *value, double *rate)
{
	const struct rb_modes *w = user;

	for (int k = 0; k < w->c->member_count && w->l->top; k++) {
		const double *const v = value + (size_t)k * (size_t)w->row;
		const rb_vec3 spin = rb_vec3_from(v + RB_PIECE_SPIN);
		const rb_quat half = {0, 0.5 * spin.x, 0.5 * spin.y, 0.5 * spin.z};
		rb_quat turn = {0, 0, 0, 0};

		if (!w->l->orientation_unused[w->c->member[k]])
			turn = rb_quat_multiply(half, rb_quat_from(v + RB_PIECE_ORIENTATION));
		rb_quat_to(rate + (size_t)k * (size_t)w->row + RB_PIECE_ORIENTATION, turn);
	}
}

/*
 * Does this cluster contain everything that moves, with no other force than attraction, on a piece
 * that continues one that was not cut, whose cost is not counted? With few bodies poses would take
 * longer than forces.
 */
static bool is_attraction(const struct rb_modes *w)
{
	const struct rb_located *l = w->l;

	return w->goes_on && w->c->held_count == 0 && w->joints.joint_count == 0 && !w->parts &&
	       !l->top && w->c->member_count == l->n && rb_located_gravitates(l) &&
	       rb_external_is_attraction(l);
}

/* rb_gauss_rates of such a cluster, by the same operations. */
static enum rb_status attract(void *user, double t, const double *value, double *rate,
                              struct rb_error *err)
{
	struct rb_modes *const w = user;
	struct rb_located *const l = w->l;
	const int *const member = w->c->member;
	const rb_vec3 gravity = l->model->scene->world.gravity;
	const size_t row = (size_t)w->row, count = (size_t)w->c->member_count;

	(void)err;
	w->time_s = t;
	w->counted = *w->calls;
	for (size_t k = 0; k < count; k++) {
		const rb_vec3 offset = rb_vec3_from(value + k * row + RB_PIECE_POSITION);
		const rb_vec3 at = rb_vec3_add(w->base[k], offset);

		rb_gravitation_place(&l->gravitation, member[k], at,
		                     rb_vec3_lost(w->base[k], offset, at));
	}
	rb_gravitation_find_by(&l->gravitation, l->world->team);
	for (size_t k = 0; k < count; k++) {
		const rb_vec3 a = rb_gravitation_found(&l->gravitation, member[k]);

		rb_vec3_to(rate + k * row + RB_PIECE_VELOCITY, rb_vec3_add(gravity, a));
	}
	return RB_OK;
}

/* rb_gauss_rates of any cluster. */
static enum rb_status all_rates(void *user, double t, const double *value, double *rate,
                                struct rb_error *err)
{
	struct rb_modes *w = user;
	const uint64_t products = w->l->products;

	const bool good = !rb_rates_are_stopped(w) &&
	                  (w->articulated ? evaluate_trees(w, t, value)
	                                  : rb_rates_evaluate(w, t, value));
	if (*w->calls == w->counted) /* for the ledger alone */
		w->l->products = products;
	w->counted = *w->calls;
	if (!good)
		return w->l->status != RB_OK
		               ? w->l->status
		               : RB_FAIL(err, RB_ERR_MEMORY, "no memory for a cluster");
	for (int k = 0; k < w->c->member_count; k++) {
		double *r = rate + (size_t)k * (size_t)w->row;

		/* the rates of positions are rows */
		rb_vec3_to(r + RB_PIECE_VELOCITY, w->linear[k]);
		if (w->l->top)
			rb_vec3_to(r + RB_PIECE_SPIN, w->angular[k]);
	}
	rb_rates_turning(w, value, rate);
	return RB_OK;
}

rb_gauss_rates *rb_rates_of(const struct rb_modes *w)
{
	return is_attraction(w) ? attract : all_rates;
}

double rb_rates_noise(void *user, const double *coefficient)
{
	const struct rb_modes *w = user;
	double worst = 0;

	for (int k = 0; k < w->c->member_count; k++) {
		const double step = 2 * DBL_EPSILON * rb_vec3_max_abs(w->base[k]);
		double path = step, change = 0;

		for (int m = 0; m < 3; m++) {
			const int x = k * w->row + RB_PIECE_POSITION + m, v = x + RB_PIECE_VELOCITY;
			double along = fabs(coefficient[x]), more = 0;

			for (int p = 1; p < RB_GAUSS_NODES; p++) {
				along += fabs(coefficient[p * w->c->piece.n + x]);
				more += fabs(coefficient[p * w->c->piece.n + v]);
			}
			path = fmax(path, along);
			change = fmax(change, more / w->scale[v]);
		}
		worst = fmax(worst, change > 0 ? change * (step / path) : 0);
	}
	return fmin(worst, rounding_error_max);
}

void rb_rates_enter_node(void *user, int node)
{
	const struct rb_modes *w = user;

	struct rb_entries rate;

	rb_work_rates(w, w->parts, w->time_s, &rate);
	memcpy(w->node_entries + (size_t)node * RB_ENTRIES, rate.row, sizeof rate.row);
}
