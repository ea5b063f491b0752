/* SPDX-License-Identifier: MIT */
#include "located/drift.h"

#include "located/joint_rows.h"
#include "located/mechanics.h"
#include "located/work.h"

#include <string.h>

enum { ROUNDS_MAX = 200 };
/* Square of the residual relative to the errors, which are close to rounding already. */
static const double tolerance = 1e-20;
/* A round that leaves more than this share of the square is useless. */
static const double stalled = 0.999;
/*
 * Compliance relative to a contact's own inverse effective mass: points that are 1e-7 of the size
 * apart, as when one feature takes over from another, would be corrected by rotations 1e7 times as
 * large as their errors, which add energy. With it motions are at most 1/(2 sqrt(share)) times as
 * large (Tikhonov's regularisation).
 */
static const double compliance_share = 0x1p-20;

static const struct rb_pose *pose_in(const struct rb_located *l, const struct rb_pose *pose,
                                     int body)
{
	return body < l->n && l->place[body] >= 0 ? &pose[l->place[body]] : NULL;
}

static struct rb_pose *pose_of(const struct rb_drift *drift, int body)
{
	const struct rb_located *l = drift->l;

	return body < l->n && l->place[body] >= 0 ? &drift->pose[l->place[body]] : NULL;
}

void rb_drift_point(const struct rb_located *l, const struct rb_pose *pose,
                    struct rb_contact_point *m)
{
	const struct rb_pose *a = pose_in(l, pose, m->a), *b = pose_in(l, pose, m->b);
	const struct rb_pose pose_a = a ? *a : m->pose_a, pose_b = b ? *b : m->pose_b;
	const struct rb_contact_name name = rb_contact_name_of(m);

	*m = rb_event_set_is_single(l, m->a, m->b)
	             ? rb_contact_point_poses(l, m->a, m->b, &pose_a, &pose_b)
	             : rb_contact_point_of(l, &name, &pose_a, &pose_b);
}

static bool sticks(const struct rb_drift *drift, int k)
{
	return drift->l->top && drift->before &&
	       (!drift->before[k].slipping || drift->before[k].ending);
}

/*
 * Does the gap need correction? Overlaps left by steps are within the tolerance, and support
 * others.
 */
static bool is_off(const struct rb_drift *drift, const struct rb_contact_point *m)
{
	return fabs(m->gap) > 0.5 * rb_contact_point_band(drift->l, m, drift->t) &&
	       m->gap > -rb_drift_correct * rb_contact_point_size(drift->l, m);
}

/* ---- a single contact ---- */

static void apply(const struct rb_drift *drift, int body, rb_vec3 arm, rb_vec3 impulse)
{
	struct rb_pose *pose = pose_of(drift, body);

	if (!pose)
		return;
	const struct rb_mechanics_change change = rb_mechanics_change(
		drift->l, body, pose->orientation, arm, impulse);

	pose->velocity = rb_vec3_add(pose->velocity, change.linear);
	pose->spin = rb_vec3_add(pose->spin, change.angular);
}

static void add_effective_mass(const struct rb_drift *drift, int body, rb_vec3 arm, rb_mat3 *k)
{
	const struct rb_pose *pose = pose_of(drift, body);

	if (pose)
		rb_mechanics_add_effective_mass(drift->l, body, pose, arm, k);
}

static void move(struct rb_pose *pose, double distance, rb_vec3 normal)
{
	if (!pose)
		return;
	rb_arc_move(pose, rb_vec3_scale(distance, normal));
	pose->origin = rb_vec3_add_scaled(pose->origin, distance, normal);
}

static void correct_one(const struct rb_drift *drift, int contact)
{
	const struct rb_model *model = drift->l->model;
	struct rb_contact_point *const m = &drift->contact_point[contact];
	rb_vec3 velocity_error = rb_vec3_scale(rb_vec3_dot(m->velocity, m->normal), m->normal);
	rb_mat3 k = {0}, inverse;

	if (is_off(drift, m)) {
		const double sum = model->inverse_mass[m->a] + model->inverse_mass[m->b];
		const double share = m->gap / sum;

		move(pose_of(drift, m->a), share * model->inverse_mass[m->a], m->normal);
		move(pose_of(drift, m->b), -share * model->inverse_mass[m->b], m->normal);
	}
	if (sticks(drift, contact))
		velocity_error = m->velocity;
	if (rb_vec3_max_abs(velocity_error) > 0) {
		add_effective_mass(drift, m->a, m->arm_a, &k);
		add_effective_mass(drift, m->b, m->arm_b, &k);
		rb_vec3 impulse;
		if (sticks(drift, contact) && rb_mat3_inverse(&k, &inverse))
			impulse = rb_vec3_neg(rb_mat3_apply(&inverse, velocity_error));
		else
			impulse = rb_vec3_scale(
				-rb_vec3_dot(velocity_error, m->normal) /
					rb_vec3_dot(m->normal, rb_mat3_apply(&k, m->normal)),
				m->normal);
		apply(drift, m->a, m->arm_a, rb_vec3_neg(impulse));
		apply(drift, m->b, m->arm_b, impulse);
		if (!drift->is_trial)
			rb_work_impact(drift->l, m, impulse, m->velocity,
			               rb_vec3_add(m->velocity, rb_mat3_apply(&k, impulse)));
	}
	rb_drift_point(drift->l, drift->pose, m);
}

/* ---- all points together ---- */

/* Errors of contacts, and the impulses (or the equivalents for positions) that correct them. */
struct errors {
	const struct rb_drift *drift;
	bool velocities; /* otherwise positions, along normals only */
	int *row;        /* [n]: contact of a row */
	int n;
	double *compliance; /* [n], 1/kg: for positions; 0 with joints */
	rb_vec3 *residual, *along, *image, *response, *sum; /* [n] */
	rb_vec3 *linear, *angular; /* [set_count]: motions by the impulses */
	struct rb_joint_hold hold; /* joints that these must respect */
};

static struct rb_mechanics_points points_of(const struct errors *e)
{
	return (struct rb_mechanics_points){.l = e->drift->l,
	                                    .contact_point = e->drift->contact_point,
	                                    .row = e->row,
	                                    .count = e->n,
	                                    .pose = e->drift->pose,
	                                    .body_count = e->drift->l->set_count,
	                                    .linear = e->linear,
	                                    .angular = e->angular};
}

static rb_vec3 constrained_part(const struct errors *e, int k, rb_vec3 v)
{
	const rb_vec3 n = e->drift->contact_point[e->row[k]].normal;

	return e->velocities && sticks(e->drift, e->row[k]) ? v
	                                                    : rb_vec3_scale(rb_vec3_dot(v, n), n);
}

/*
 * Computes the motions of all bodies by impulses, and their effects at the contacts, into `image`.
 */
static void respond(struct errors *e, const rb_vec3 *impulse, rb_vec3 *image)
{
	const struct rb_mechanics_points points = points_of(e);

	rb_mechanics_respond(&points, impulse);
	rb_joint_hold_apply(&e->hold, e->linear, e->angular);
	for (int k = 0; k < e->n; k++) {
		image[k] = constrained_part(e, k, rb_mechanics_response(&points, k));
		if (!e->velocities)
			image[k] = rb_vec3_add_scaled(image[k], e->compliance[k], impulse[k]);
	}
}

static double dots(const rb_vec3 *a, const rb_vec3 *b, int n)
{
	double sum = 0;

	for (int k = 0; k < n; k++)
		sum += rb_vec3_dot(a[k], b[k]);
	return sum;
}

/*
 * The smallest motion that cancels the errors in `residual`, by conjugate residuals (Stiefel,
 * Comment. Math. Helv. 29 (1955) 157): these keep falling if more contacts than degrees of freedom
 * contradict each other. Leaves it in e->linear and e->angular.
 */
static void solve(struct errors *e)
{
	const int n = e->n;

	for (int k = 0; k < n; k++) {
		e->sum[k] = (rb_vec3){0, 0, 0};
		e->along[k] = e->residual[k];
	}
	const double start = dots(e->residual, e->residual, n);
	double square = start;
	respond(e, e->residual, e->response);
	double curvature = dots(e->residual, e->response, n);
	memcpy(e->image, e->response, (size_t)n * sizeof *e->image);
	for (int round = 0; round < ROUNDS_MAX && square > tolerance * start && curvature > 0;
	     round++) {
		const double whole = dots(e->image, e->image, n);

		if (!(whole > 0))
			break;
		const double share = curvature / whole, before = square;
		for (int k = 0; k < n; k++)
			e->residual[k] = rb_vec3_add_scaled(e->residual[k], -share, e->image[k]);
		square = dots(e->residual, e->residual, n);
		/* the rest is rounding, and contacts that contradict each other */
		if (!(square < stalled * before))
			break;
		for (int k = 0; k < n; k++)
			e->sum[k] = rb_vec3_add_scaled(e->sum[k], share, e->along[k]);
		respond(e, e->residual, e->response);
		const double next = dots(e->residual, e->response, n), keep = next / curvature;
		for (int k = 0; k < n; k++) {
			e->along[k] = rb_vec3_add_scaled(e->residual[k], keep, e->along[k]);
			e->image[k] = rb_vec3_add_scaled(e->response[k], keep, e->image[k]);
		}
		curvature = next;
	}
	respond(e, e->sum, e->image);
}

static bool take(struct errors *e)
{
	struct rb_arena *arena = e->drift->l->arena;
	const size_t n = (size_t)e->drift->count + 1, bodies = (size_t)e->drift->l->set_count + 1;

	e->row = rb_arena_take(arena, n, sizeof *e->row);
	e->compliance = rb_arena_take(arena, n, sizeof *e->compliance);
	e->residual = rb_arena_take(arena, 5 * n, sizeof *e->residual);
	e->linear = rb_arena_take(arena, 2 * bodies, sizeof *e->linear);
	if (!e->row || !e->compliance || !e->residual || !e->linear)
		return false;
	e->along = e->residual + n;
	e->image = e->along + n;
	e->response = e->image + n;
	e->sum = e->response + n;
	e->angular = e->linear + bodies;
	for (int k = 0; k < e->drift->count; k++)
		if (e->drift->kept[k])
			e->row[e->n++] = k;
	return rb_joint_hold_take(&e->hold, e->drift->l, e->drift->pose, e->drift->t, false);
}

static void contact_points_of(const struct rb_drift *drift)
{
	for (int k = 0; k < drift->count; k++)
		if (drift->kept[k])
			rb_drift_point(drift->l, drift->pose, &drift->contact_point[k]);
}

/* Compliance of a contact's position, 1/kg. */
static double compliance_of(const struct rb_drift *drift, const struct rb_contact_point *m)
{
	rb_mat3 k = {0};

	add_effective_mass(drift, m->a, m->arm_a, &k);
	add_effective_mass(drift, m->b, m->arm_b, &k);
	return compliance_share * rb_vec3_dot(m->normal, rb_mat3_apply(&k, m->normal));
}

static void move_places(struct errors *e)
{
	const struct rb_located *l = e->drift->l;
	bool any = false;

	e->velocities = false;
	for (int k = 0; k < e->n; k++) {
		const struct rb_contact_point *m = &e->drift->contact_point[e->row[k]];
		const bool off = is_off(e->drift, m);

		e->residual[k] = off ? rb_vec3_scale(-m->gap, m->normal) : (rb_vec3){0, 0, 0};
		e->compliance[k] = e->hold.rows.count > 0 ? 0 : compliance_of(e->drift, m);
		any = any || off;
	}
	if (!any)
		return;
	solve(e);
	for (int k = 0; k < l->set_count; k++)
		rb_arc_displace(l, l->set[k], &e->drift->pose[k], e->linear[k], e->angular[k]);
	contact_points_of(e->drift);
}

/* Enters the effects of the impulses in `sum`, by e->linear and e->angular, into the ledger. */
static void enter(const struct errors *e)
{
	const struct rb_mechanics_points points = points_of(e);

	for (int k = 0; k < e->n; k++) {
		const struct rb_contact_point *m = &e->drift->contact_point[e->row[k]];

		rb_work_impact(e->drift->l, m, e->sum[k], m->velocity,
		               rb_vec3_add(m->velocity, rb_mechanics_response(&points, k)));
	}
	if (e->hold.rows.count == 0 || !e->drift->l->account_s)
		return;
	struct rb_entries entries = {0};

	for (int k = 0; k < e->hold.rows.count; k++) {
		const struct rb_joint_row *row = &e->hold.rows.row[k];
		const double impulse = e->hold.dense.right[k];

		/* a motor that holds its speed does work, however small the change is */
		rb_entries_energy(&entries, RB_ENERGY_DRIVEN,
		                  rb_joint_rows_power(&e->hold.rows, row, impulse, e->drift->t));
		rb_joint_rows_enter(&e->hold.rows, row, impulse, e->drift->t, &entries);
	}
	rb_ledger_enter(&e->drift->l->world->ledger, &entries);
}

static void move_velocities(struct errors *e)
{
	bool any = false;

	e->velocities = true;
	for (int k = 0; k < e->n; k++) {
		e->residual[k] = rb_vec3_neg(
			constrained_part(e, k, e->drift->contact_point[e->row[k]].velocity));
		any = any || rb_vec3_max_abs(e->residual[k]) > 0;
	}
	if (!any)
		return;
	solve(e);
	if (!e->drift->is_trial)
		enter(e);
	for (int k = 0; k < e->drift->l->set_count; k++) {
		struct rb_pose *pose = &e->drift->pose[k];

		pose->velocity = rb_vec3_add(pose->velocity, e->linear[k]);
		pose->spin = rb_vec3_add(pose->spin, e->angular[k]);
	}
	contact_points_of(e->drift);
}

static bool is_single(const struct rb_drift *drift)
{
	bool single = !drift->l->model->joints;

	for (int k = 0; k < drift->count; k++)
		single = single && rb_event_set_is_single(drift->l, drift->contact_point[k].a,
		                                          drift->contact_point[k].b);
	return single;
}

static void correct_together(struct rb_drift *drift, bool places, bool velocities)
{
	const rb_arena_mark here = rb_arena_here(drift->l->arena);
	struct errors e = {.drift = drift};

	/* without memory the drift remains, and is corrected later */
	if (drift->count > 0 && take(&e)) {
		contact_points_of(drift);
		if (places)
			move_places(&e);
		if (velocities)
			move_velocities(&e);
	}
	rb_arena_back(drift->l->arena, here);
}

void rb_drift(struct rb_drift *drift)
{
	if (!is_single(drift)) {
		correct_together(drift, true, true);
		return;
	}
	for (int k = 0; k < drift->count; k++)
		if (drift->kept[k]) {
			rb_drift_point(drift->l, drift->pose, &drift->contact_point[k]);
			correct_one(drift, k);
		}
}

void rb_drift_places(struct rb_drift *drift)
{
	if (!is_single(drift))
		correct_together(drift, true, false);
}

void rb_drift_stop(struct rb_drift *drift)
{
	correct_together(drift, false, true);
}
