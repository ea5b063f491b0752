/* SPDX-License-Identifier: MIT */
#include "located/drift.h"

#include "located/joint_rows.h"
#include "located/mechanics.h"
#include "located/work.h"

#include <string.h>

enum { ROUNDS_MAX = 200 };
/* What is left of the square of errors that are near rounding already. */
static const double tolerance = 1e-20;
/* A round that leaves more than this share of it is of no use. */
static const double stalled = 0.999;
/*
 * Of a contact's own effective mass: points that lie 1e-7 of the size apart, as where one feature
 * takes over from another, would be put right by turns 1e7 times as large as their errors, and a
 * turn of all is energy from nowhere. With it motions are at most 1/(2 sqrt(share)) times as large
 * (Tikhonov's regularisation).
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

/* An overlap that steps have left is within the tolerance, and others lean on it. */
static bool is_off(const struct rb_drift *drift, const struct rb_contact_point *m)
{
	return fabs(m->gap) > 0.5 * rb_contact_point_band(drift->l, m, drift->t) &&
	       m->gap > -rb_drift_correct * rb_contact_point_size(drift->l, m);
}

/* ---- one contact ---- */

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

static void move(struct rb_pose *pose, double way, rb_vec3 normal)
{
	if (!pose)
		return;
	rb_arc_move(pose, rb_vec3_scale(way, normal));
	pose->origin = rb_vec3_add_scaled(pose->origin, way, normal);
}

static void correct_one(const struct rb_drift *drift, int which)
{
	const struct rb_model *model = drift->l->model;
	struct rb_contact_point *const m = &drift->contact_point[which];
	rb_vec3 wrong = rb_vec3_scale(rb_vec3_dot(m->velocity, m->normal), m->normal);
	rb_mat3 k = {0}, inverse;

	if (is_off(drift, m)) {
		const double sum = model->inverse_mass[m->a] + model->inverse_mass[m->b];
		const double share = m->gap / sum;

		move(pose_of(drift, m->a), share * model->inverse_mass[m->a], m->normal);
		move(pose_of(drift, m->b), -share * model->inverse_mass[m->b], m->normal);
	}
	if (sticks(drift, which))
		wrong = m->velocity;
	if (rb_vec3_max_abs(wrong) > 0) {
		add_effective_mass(drift, m->a, m->arm_a, &k);
		add_effective_mass(drift, m->b, m->arm_b, &k);
		rb_vec3 impulse;
		if (sticks(drift, which) && rb_mat3_inverse(&k, &inverse))
			impulse = rb_vec3_neg(rb_mat3_apply(&inverse, wrong));
		else
			impulse = rb_vec3_scale(
				-rb_vec3_dot(wrong, m->normal) /
					rb_vec3_dot(m->normal, rb_mat3_apply(&k, m->normal)),
				m->normal);
		apply(drift, m->a, m->arm_a, rb_vec3_neg(impulse));
		apply(drift, m->b, m->arm_b, impulse);
		if (!drift->tries)
			rb_work_impact(drift->l, m, impulse, m->velocity,
			               rb_vec3_add(m->velocity, rb_mat3_apply(&k, impulse)));
	}
	rb_drift_point(drift->l, drift->pose, m);
}

/* ---- all points together ---- */

/* What is wrong with each contact, and the impulses (or their kind for places) that end it. */
struct errors {
	const struct rb_drift *drift;
	bool velocities; /* else places: only along normals */
	int *row;        /* [n]: contact of each */
	int n;
	double *compliance; /* [n], 1/kg: of places; 0 where joints take part */
	rb_vec3 *left, *along, *image, *answer, *sum; /* [n] */
	rb_vec3 *linear, *angular;                    /* [set_count]: motions by impulses */
	struct rb_joint_hold hold;                    /* what these must respect */
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

static rb_vec3 asked_of(const struct errors *e, int k, rb_vec3 v)
{
	const rb_vec3 n = e->drift->contact_point[e->row[k]].normal;

	return e->velocities && sticks(e->drift, e->row[k]) ? v
	                                                    : rb_vec3_scale(rb_vec3_dot(v, n), n);
}

/* Motions of all bodies by impulses, and what they do to the contacts, into `image`. */
static void respond(struct errors *e, const rb_vec3 *impulse, rb_vec3 *image)
{
	const struct rb_mechanics_points points = points_of(e);

	rb_mechanics_respond(&points, impulse);
	rb_joint_hold_apply(&e->hold, e->linear, e->angular);
	for (int k = 0; k < e->n; k++) {
		image[k] = asked_of(e, k, rb_mechanics_response(&points, k));
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
 * The smallest motion that ends the errors in `left`, by conjugate residuals (Stiefel, Comment.
 * Math. Helv. 29 (1955) 157): they go on falling where more contacts than freedoms contradict each
 * other. Leaves it in e->linear and e->angular.
 */
static void solve(struct errors *e)
{
	const int n = e->n;

	for (int k = 0; k < n; k++) {
		e->sum[k] = (rb_vec3){0, 0, 0};
		e->along[k] = e->left[k];
	}
	const double start = dots(e->left, e->left, n);
	double square = start;
	respond(e, e->left, e->answer);
	double bend = dots(e->left, e->answer, n);
	memcpy(e->image, e->answer, (size_t)n * sizeof *e->image);
	for (int round = 0; round < ROUNDS_MAX && square > tolerance * start && bend > 0; round++) {
		const double whole = dots(e->image, e->image, n);

		if (!(whole > 0))
			break;
		const double share = bend / whole, before = square;
		for (int k = 0; k < n; k++)
			e->left[k] = rb_vec3_add_scaled(e->left[k], -share, e->image[k]);
		square = dots(e->left, e->left, n);
		/* what does not fall is rounding, and contacts that contradict each other */
		if (!(square < stalled * before))
			break;
		for (int k = 0; k < n; k++)
			e->sum[k] = rb_vec3_add_scaled(e->sum[k], share, e->along[k]);
		respond(e, e->left, e->answer);
		const double next = dots(e->left, e->answer, n), keep = next / bend;
		for (int k = 0; k < n; k++) {
			e->along[k] = rb_vec3_add_scaled(e->left[k], keep, e->along[k]);
			e->image[k] = rb_vec3_add_scaled(e->answer[k], keep, e->image[k]);
		}
		bend = next;
	}
	respond(e, e->sum, e->image);
}

static bool take(struct errors *e)
{
	struct rb_arena *arena = e->drift->l->arena;
	const size_t n = (size_t)e->drift->count + 1, bodies = (size_t)e->drift->l->set_count + 1;

	e->row = rb_arena_take(arena, n, sizeof *e->row);
	e->compliance = rb_arena_take(arena, n, sizeof *e->compliance);
	e->left = rb_arena_take(arena, 5 * n, sizeof *e->left);
	e->linear = rb_arena_take(arena, 2 * bodies, sizeof *e->linear);
	if (!e->row || !e->compliance || !e->left || !e->linear)
		return false;
	e->along = e->left + n;
	e->image = e->along + n;
	e->answer = e->image + n;
	e->sum = e->answer + n;
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

/* 1/kg: compliance of a contact's place. */
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

		e->left[k] = off ? rb_vec3_scale(-m->gap, m->normal) : (rb_vec3){0, 0, 0};
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

/* What the impulses in `sum` do by e->linear and e->angular. */
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

		/* a motor that keeps its speed does work, however small the change is */
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
		e->left[k] = rb_vec3_neg(
			asked_of(e, k, e->drift->contact_point[e->row[k]].velocity));
		any = any || rb_vec3_max_abs(e->left[k]) > 0;
	}
	if (!any)
		return;
	solve(e);
	if (!e->drift->tries)
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

	/* without memory the drift stays, and is put right another time */
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
