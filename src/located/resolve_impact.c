/* SPDX-License-Identifier: MIT */
/*
 * Impacts of all touching bodies, solved simultaneously (constraint/simultaneous) with Newton's
 * restitution and Coulomb's friction.
 * A rebound that would stay below rounding begins an infinite series (Zeno): it ends at once and is
 * reported at the time of its limit (located/bounces).
 */
#include "located/resolve_impact.h"

#include "base/error.h"

#include <float.h>
#include <string.h>

#include "base/memory.h"
#include "constraint/contact_row.h"
#include "located/account.h"
#include "located/bounces.h"
#include "located/interleaved.h"
#include "located/pair_impact.h"
#include "located/joint_stops.h"
#include "located/mechanics.h"
#include "located/resolve_contacts.h"
#include "located/event_records.h"
#include "located/drift.h"
#include "located/work.h"

/*
 * Largest change of velocities by stopping rebounds, relative to these; beyond it, the cause is not
 * the rebounds.
 */
static const double stop_ratio_max = 1e3;

/*
 * Passes of stopping; rounds of impacts and contacts, each of which doubles the digits of a rim's
 * point.
 */
enum { STOP_PASSES = 64, ROUNDS_MAX = 16 };

/* ---- simultaneous impacts ---- */

/* State of a simultaneous impact. */
struct impact {
	struct rb_located *l;
	double t;
	struct rb_contact_point *contact_point;
	int contact_point_count;
	struct rb_pose *pose; /* [set_count] */
	struct rb_simultaneous problem;
	struct rb_joint_rows joints;
	int fixed;    /* number of bodies before those added as ends of joints */
	double slack; /* m/s: rounding of the velocities before */
};

/* Place of a member, or a new copy of a fixed body. */
static int body_of(struct impact *s, int body, const struct rb_pose *pose)
{
	struct rb_located *l = s->l;

	if (body < l->n && l->place[body] >= 0)
		return l->place[body];
	/* fixed: each contact has its own copy of a body that is not dynamic */
	s->problem.body[s->problem.body_count] = (struct rb_solver_body){.linear = pose->velocity,
	                                                                 .angular = pose->spin};
	return s->problem.body_count++;
}

static struct rb_drift drift_of(struct impact *s, const bool *kept)
{
	return (struct rb_drift){.l = s->l,
	                         .t = s->t,
	                         .contact_point = s->contact_point,
	                         .kept = kept,
	                         .count = s->contact_point_count,
	                         .pose = s->pose};
}

/*
 * Removes the drift of pairs held at several points that now touch at another one: it would sustain
 * a series of impacts.
 */
static bool correct_drift(struct impact *s)
{
	struct rb_located *l = s->l;
	bool *const kept = rb_arena_take(l->arena, (size_t)s->contact_point_count + 1,
	                                 sizeof *kept);
	struct rb_pose *const from = rb_arena_take(l->arena, (size_t)l->set_count + 1,
	                                           sizeof *from);
	struct rb_drift drift = drift_of(s, kept);

	if (!kept || !from)
		return false;
	memcpy(from, s->pose, (size_t)l->set_count * sizeof *from);
	for (int k = 0; k < s->contact_point_count; k++)
		kept[k] = rb_event_set_held(l, s->contact_point[k].a, s->contact_point[k].b) !=
		          NULL;
	rb_drift_places(&drift);
	rb_work_moved(l, from, s->pose);
	return true;
}

/* Sets the joints that take part. */
static void pose_joints(struct impact *s)
{
	s->problem.body_count = s->fixed;
	s->problem.joint_count = rb_joint_rows_pose_problem(
		&s->joints, false, s->problem.joint_row, s->problem.body, &s->problem.body_count);
}

/* Sets bodies and contacts. */
static bool build(struct impact *s)
{
	struct rb_located *l = s->l;

	s->pose = rb_arena_take(l->arena, (size_t)l->set_count + 1, sizeof *s->pose);
	s->joints = (struct rb_joint_rows){.l = l,
	                                   .body = l->set,
	                                   .pose = s->pose,
	                                   .body_count = l->set_count,
	                                   .touching = true};
	if (!rb_joint_rows_collect(&s->joints))
		return false;
	s->problem.body = rb_arena_take(
		l->arena,
		(size_t)(l->set_count + 2 * s->contact_point_count + 2 * s->joints.count + 1),
		sizeof *s->problem.body);
	s->problem.joint_row = rb_arena_take(l->arena, (size_t)s->joints.count + 1,
	                                     sizeof *s->problem.joint_row);
	s->problem.contact = rb_arena_take(l->arena, (size_t)s->contact_point_count + 1,
	                                   sizeof *s->problem.contact);
	rb_mat3 *const root = rb_arena_take(l->arena, (size_t)l->set_count + 1, sizeof *root);
	if (!s->pose || !s->problem.body || !s->problem.contact || !root || !s->problem.joint_row)
		return false;
	s->problem.root = root;
	s->problem.arena = l->arena;
	s->problem.body_count = l->set_count;
	s->problem.contact_count = s->contact_point_count;
	for (int k = 0; k < l->set_count; k++)
		s->pose[k] = rb_arc_pose(l, l->set[k], s->t);
	if (!correct_drift(s))
		return false;
	for (int k = 0; k < l->set_count; k++) {
		s->problem.body[k] = rb_mechanics_body(l, l->set[k], s->pose[k].velocity,
		                                       s->pose[k].spin);
		root[k] = rb_mechanics_root(l, l->set[k], &s->pose[k]);
	}
	for (int k = 0; k < s->contact_point_count; k++) {
		struct rb_contact_point *m = &s->contact_point[k];

		s->problem.contact[k] = rb_mechanics_contact(l, m);
		s->problem.contact[k].noise = rb_contact_point_noise(l, m);
		s->problem.contact[k].pair[0] = m->a;
		s->problem.contact[k].pair[1] = m->b;
		s->problem.contact[k].a = body_of(s, m->a, &m->pose_a);
		s->problem.contact[k].b = body_of(s, m->b, &m->pose_b);
		s->slack = fmax(s->slack, s->problem.contact[k].noise);
	}
	rb_joint_rows_fill(&s->joints, s->t);
	s->fixed = s->problem.body_count;
	pose_joints(s);
	for (int k = 0; k < s->joints.count; k++)
		s->slack = fmax(s->slack, s->joints.row[k].noise);
	return true;
}

/* Relative velocity at contact k after the impact. */
static rb_vec3 velocity_after(const struct impact *s, int k)
{
	const struct rb_solver_contact *c = &s->problem.contact[k];
	const struct rb_solver_body *a = &s->problem.body[c->a], *b = &s->problem.body[c->b];

	return rb_vec3_sub(rb_solver_point_velocity(b, c->arm_b),
	                   rb_solver_point_velocity(a, c->arm_a));
}

/* Lever arm of a normal impulse, m; zero if it is only rounding. */
static rb_vec3 lever_of(rb_vec3 arm, rb_vec3 normal)
{
	const rb_vec3 lever = rb_vec3_cross(arm, normal);
	const bool central = rb_vec3_length(lever) <= 16 * DBL_EPSILON * rb_vec3_length(arm);

	return central ? (rb_vec3){0, 0, 0} : lever;
}

/* Change of spin by a unit normal impulse. */
static rb_vec3 turn_by(const struct impact *s, int place, rb_vec3 lever)
{
	if (place >= s->l->set_count || !s->l->top || !(rb_vec3_max_abs(lever) > 0))
		return (rb_vec3){0, 0, 0};
	return rb_inverse_inertia_apply(s->l, s->l->set[place], s->pose[place].orientation, lever);
}

/* Removes the normal velocity of contact k. */
static void stop_normal(struct impact *s, int k, double target_velocity)
{
	const struct rb_solver_contact *c = &s->problem.contact[k];
	struct rb_solver_body *a = &s->problem.body[c->a], *b = &s->problem.body[c->b];
	const rb_vec3 lever_a = lever_of(c->arm_a, c->normal);
	const rb_vec3 lever_b = lever_of(c->arm_b, c->normal);
	const rb_vec3 turn_a = turn_by(s, c->a, lever_a), turn_b = turn_by(s, c->b, lever_b);
	const double sum = a->inverse_mass + b->inverse_mass + rb_vec3_dot(lever_a, turn_a) +
	                   rb_vec3_dot(lever_b, turn_b);

	if (!(sum > 0))
		return;
	const rb_vec3 before = velocity_after(s, k);
	a->linear = rb_vec3_add_scaled(a->linear, target_velocity * a->inverse_mass / sum,
	                               c->normal);
	b->linear = rb_vec3_add_scaled(b->linear, -target_velocity * b->inverse_mass / sum,
	                               c->normal);
	a->angular = rb_vec3_add_scaled(a->angular, target_velocity / sum, turn_a);
	b->angular = rb_vec3_add_scaled(b->angular, -target_velocity / sum, turn_b);
	rb_work_impact(s->l, &s->contact_point[k], rb_vec3_scale(-target_velocity / sum, c->normal),
	               before, velocity_after(s, k));
}

/*
 * True if another contact at the same place holds the body, so that nothing brings this one back.
 */
static bool is_taken_over(const struct impact *s, int k)
{
	for (int i = 0; i < s->contact_point_count; i++)
		if (i != k &&
		    rb_event_set_is_shared_place(s->l, &s->contact_point[k],
		                                 &s->contact_point[i]) &&
		    fabs(rb_vec3_dot(velocity_after(s, i), s->problem.contact[i].normal)) <=
		            s->problem.contact[i].noise)
			return true;
	return false;
}

/*
 * Duration of the infinite series of rebounds that begins with this one, s; < 0: none begins,
 * though this may be a bounce of one.
 */
static double accumulation(struct impact *s, int k)
{
	struct rb_located *l = s->l;
	const struct rb_solver_contact *c = &s->problem.contact[k];
	struct rb_pose pose_a = s->contact_point[k].pose_a, pose_b = s->contact_point[k].pose_b;

	pose_a.velocity = s->problem.body[c->a].linear;
	pose_a.spin = s->problem.body[c->a].angular;
	pose_b.velocity = s->problem.body[c->b].linear;
	pose_b.spin = s->problem.body[c->b].angular;
	const struct rb_contact_point *m = &s->contact_point[k];
	const struct rb_contact_name name = rb_contact_name_of(m);
	const struct rb_contact_point after = rb_event_set_is_single(l, m->a, m->b)
	                                              ? rb_contact_point_poses(l, m->a, m->b,
	                                                                       &pose_a, &pose_b)
	                                              : rb_contact_point_of(l, &name, &pose_a,
	                                                                    &pose_b);
	const double target_velocity = rb_vec3_dot(velocity_after(s, k), c->normal);
	/* the other end of a rocking body, or another link, lifts without impulse */
	const bool took_part = c->approach > 0 || rb_vec3_dot(c->impulse, c->normal) > 0 ||
	                       rb_event_set_continued(l, m);
	if (!took_part || !(target_velocity > 0))
		return -1;
	const double closing = rb_bounces_closing(l, &after, s->t);
	const bool bounces = closing > 0 && c->approach > 0 && c->restitution > 0 &&
	                     c->restitution < 1 && rb_event_set_is_single(l, m->a, m->b);
	if (bounces)
		rb_bounces_note(l, &after, s->t, target_velocity, closing, c->restitution);
	if (!rb_pair_impact_ends(l, &after, target_velocity, closing) || is_taken_over(s, k))
		return -1;
	if (bounces)
		return rb_bounces_left(l, &after, s->t);
	return c->restitution < 1 ? 2 * target_velocity / (closing * (1 - c->restitution)) : 0;
}

/* Records the end of impact series between bodies that nothing presses together. */
static void record_ends(struct impact *s)
{
	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_solver_contact *c = &s->problem.contact[k];

		if (k > 0 && s->contact_point[k - 1].a == s->contact_point[k].a &&
		    s->contact_point[k - 1].b == s->contact_point[k].b)
			continue;
		if (c->approach > 0 && c->restitution > 0 &&
		    rb_vec3_dot(velocity_after(s, k), c->normal) <= c->noise)
			rb_record_transition(s->l, s->t, RB_EVENT_MERGE, &s->contact_point[k]);
	}
}

/* Stops contacts one after the other, repeatedly, because stopping one may move another. */
static void stop_one_by_one(struct impact *s, const bool *ends)
{
	/* until all are at rest */
	for (int pass = 0; pass < STOP_PASSES; pass++) {
		bool moved = false;

		for (int k = 0; k < s->contact_point_count; k++) {
			const struct rb_solver_contact *c = &s->problem.contact[k];
			const double target_velocity = rb_vec3_dot(velocity_after(s, k), c->normal);

			if (!ends[k] || fabs(target_velocity) <= 0.5 * c->noise)
				continue;
			stop_normal(s, k, target_velocity);
			moved = true;
		}
		if (!moved)
			break;
	}
}

/* Adds the contacts that now approach, or that separate and were at rest; true: there were any. */
static bool add_moving(const struct impact *s, const bool *stopped, bool *kept)
{
	bool any = false;

	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_solver_contact *c = &s->problem.contact[k];
		const double target_velocity = rb_vec3_dot(velocity_after(s, k), c->normal);

		if (kept[k] ||
		    !(target_velocity < -c->noise || (stopped[k] && target_velocity > c->noise)))
			continue;
		kept[k] = any = true;
	}
	return any;
}

/* Largest change of a member's velocity, at its surface, m/s. */
static double largest_change(const struct impact *s, const struct rb_solver_body *before)
{
	double max = 0;

	for (int k = 0; k < s->l->set_count; k++) {
		const rb_vec3 linear_change = rb_vec3_sub(s->problem.body[k].linear,
		                                          before[k].linear);
		const rb_vec3 angular_change = rb_vec3_sub(s->problem.body[k].angular,
		                                           before[k].angular);
		const double reach = rb_model_reach(s->l->model, s->l->set[k]);

		max = fmax(max, rb_vec3_length(linear_change));
		if (s->l->top)
			max = fmax(max, reach * rb_vec3_length(angular_change));
	}
	return max;
}

/* Largest rebound among contacts that end, m/s. */
static double largest_rebound(const struct impact *s, const bool *ends)
{
	double max = 0;

	for (int k = 0; k < s->contact_point_count; k++)
		if (ends[k])
			max = fmax(max, fabs(rb_vec3_dot(velocity_after(s, k),
			                                 s->problem.contact[k].normal)));
	return max;
}

/* Sets the velocities `before` without the rebounds of `drift`. */
static void stop_from(struct impact *s, struct rb_drift *drift, const struct rb_solver_body *before)
{
	for (int k = 0; k < s->l->set_count; k++) {
		s->pose[k].velocity = before[k].linear;
		s->pose[k].spin = before[k].angular;
	}
	rb_drift_stop(drift);
	for (int k = 0; k < s->l->set_count; k++) {
		s->problem.body[k].linear = s->pose[k].velocity;
		s->problem.body[k].angular = s->pose[k].spin;
	}
}

/*
 * Stops contacts of connected points together, by the smallest change that removes their rebounds,
 * which dissipates. Contacts that it would make approach, or lift from rest, are stopped too.
 * Undone if it changes too much: for a body that rolls over an edge that protrudes by rounding,
 * only rest would satisfy both sides.
 */
static void stop_together(struct impact *s, bool *ends)
{
	struct rb_drift drift = drift_of(s, ends);

	drift.is_trial = true;
	const size_t count = (size_t)s->l->set_count;
	struct rb_solver_body *const before = rb_arena_take(s->l->arena, count, sizeof *before);
	bool *const stopped = rb_arena_take(s->l->arena, (size_t)s->contact_point_count,
	                                    sizeof *stopped);
	bool more = before && stopped;

	for (int k = 0; k < s->contact_point_count && more; k++)
		stopped[k] = fabs(rb_vec3_dot(velocity_after(s, k),
		                              s->problem.contact[k].normal)) <=
		             s->problem.contact[k].noise;
	if (more)
		memcpy(before, s->problem.body, count * sizeof *before);
	const double rebound = largest_rebound(s, ends);
	for (int pass = 0; pass <= s->contact_point_count && more; pass++) {
		stop_from(s, &drift, before);
		more = pass < s->contact_point_count && add_moving(s, stopped, ends);
	}
	if (!before || !stopped)
		s->l->status = RB_FAIL(s->l->err, RB_ERR_MEMORY, "no memory for a contact");
	else if (!(largest_change(s, before) <= stop_ratio_max * rebound))
		memcpy(s->problem.body, before, count * sizeof *before);
	else if (s->l->account_s) { /* repeated with ledger entries */
		drift.is_trial = false;
		stop_from(s, &drift, before);
	}
}

/*
 * Ends series of rebounds that stay within rounding of sizes: the contact lasts from now on and is
 * reported at the limit of the series.
 */
static void end_accumulations(struct impact *s)
{
	struct rb_located *l = s->l;
	bool *const ends = rb_arena_take(l->arena, (size_t)s->contact_point_count + 1,
	                                 sizeof *ends);
	bool any = false, single = s->joints.count == 0;

	if (!ends || !rb_memory_reserve(&l->merge, &l->merge_capacity,
	                                (size_t)(l->merge_count + s->contact_point_count),
	                                sizeof *l->merge)) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for a contact");
		return;
	}
	for (int k = 0; k < s->contact_point_count; k++) {
		const double rest_s = accumulation(s, k);

		ends[k] = rest_s >= 0;
		if (!ends[k])
			continue;
		any = true;
		single = single &&
		         rb_event_set_is_single(l, s->contact_point[k].a, s->contact_point[k].b);
		l->merge[l->merge_count++] = (struct rb_merge){.recorded_s = s->t + rest_s,
		                                               .a = s->contact_point[k].a,
		                                               .b = s->contact_point[k].b};
	}
	if (any && s->joints.count > 0)
		rb_joint_stops_end_drives(&s->joints, &s->problem, s->pose, s->t, s->slack);
	if (any && single)
		stop_one_by_one(s, ends);
	else if (any)
		stop_together(s, ends);
}

/* Records one event for each pair: the sum of its impulses, at their centre. */
static void record_pair(struct impact *s, int first, int end)
{
	struct rb_contact_point m = s->contact_point[first];
	rb_vec3 impulse = {0, 0, 0}, point = {0, 0, 0};
	double approach = 0, normal_impulse = 0;

	for (int k = first; k < end; k++) {
		const struct rb_solver_contact *c = &s->problem.contact[k];
		const double own = rb_vec3_dot(c->impulse, c->normal);

		impulse = rb_vec3_add(impulse, c->impulse);
		if (own > 0) /* relative to the first point, for the digits */
			point = rb_vec3_add_scaled(point, own,
			                           rb_vec3_sub(s->contact_point[k].point,
			                                       s->contact_point[first].point));
		normal_impulse += fmax(own, 0);
		if (c->approach > approach) {
			approach = c->approach;
			m.normal = c->normal;
		}
	}
	if (!(approach > 0))
		return;
	if (end > first + 1 && normal_impulse > 0)
		m.point = rb_vec3_add_scaled(m.point, 1 / normal_impulse, point);
	rb_record_impact(s->l, s->t, &m, impulse, approach);
}

/* Events of all pairs. */
static void record_impacts(struct impact *s)
{
	int first = 0;

	for (int k = 1; k <= s->contact_point_count; k++)
		if (k == s->contact_point_count ||
		    s->contact_point[k].a != s->contact_point[first].a ||
		    s->contact_point[k].b != s->contact_point[first].b) {
			record_pair(s, first, k);
			first = k;
		}
}

/* ---- the ledger ---- */

/* Relative velocities before the impact, for the ledger; NULL without one. */
static rb_vec3 *velocities_before(struct impact *s)
{
	struct rb_located *l = s->l;

	if (!l->account_s)
		return NULL;
	rb_vec3 *const approach = rb_arena_take(l->arena, (size_t)s->contact_point_count + 1,
	                                        sizeof *approach);
	if (!approach)
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for an impact of %d bodies",
		                    l->set_count);
	for (int k = 0; approach && k < s->contact_point_count; k++)
		approach[k] = velocity_after(s, k);
	return approach;
}

/* Enters the work of the impulses. */
static void enter_impulses(struct impact *s, const rb_vec3 *approach)
{
	for (int k = 0; approach && k < s->contact_point_count; k++)
		rb_work_impact(s->l, &s->contact_point[k], s->problem.contact[k].impulse,
		               approach[k], velocity_after(s, k));
	if (s->joints.count > 0)
		rb_joint_stops_enter_impact(&s->joints, &s->problem, s->t);
}

/*
 * Solves the impact; repeats it if rebounds at stops would continue within rounding: each time at
 * least one stop loses its restitution, or another drive takes part.
 */
static bool solve_impact(struct impact *s, int *rounds)
{
	bool solved, more;

	do {
		solved = rb_simultaneous_impact(&s->problem, rounds);
		more = solved && rb_joint_stops_include(&s->joints, &s->problem);
		if (more)
			pose_joints(s);
		else
			more = solved && rb_joint_stops_end(&s->joints, &s->problem, s->t);
		for (int k = 0; k < s->l->set_count && more; k++) {
			s->problem.body[k].linear = s->pose[k].velocity;
			s->problem.body[k].angular = s->pose[k].spin;
		}
	} while (more && s->l->status == RB_OK);
	return solved;
}

/*
 * Speed of each contact that counts as rest, m/s, because its bodies are jammed in interleaved
 * impacts. True: they are.
 */
static bool note_interleaved(struct impact *s, double *speed)
{
	const struct rb_contact_point *const first = s->contact_point;
	bool several_pairs = false;
	double count = 0;

	for (int k = 1; k < s->contact_point_count; k++)
		several_pairs = several_pairs || first[k].a != first->a || first[k].b != first->b;
	for (int k = 0; k < s->contact_point_count; k++)
		if (s->problem.contact[k].approach > 0)
			count = fmax(count, rb_interleaved_note(s->l, &s->contact_point[k], s->t,
			                                        several_pairs));
	for (int k = 0; k < s->contact_point_count; k++)
		speed[k] = rb_interleaved_speed(s->l, &s->contact_point[k], count);
	return s->contact_point_count > 0 && speed[0] > 0;
}

/*
 * Ends the rest of a jam: contacts slower than its speed of rest stop here. Undone if it changes
 * too much, as above: a ball that slides over a fold of the floor would stop there.
 */
static void end_interleaved(struct impact *s)
{
	struct rb_located *l = s->l;
	const size_t count = (size_t)s->contact_point_count + 1;
	const size_t members = (size_t)l->set_count;
	bool *const ends = rb_arena_take(l->arena, count, sizeof *ends);
	double *const rest = rb_arena_take(l->arena, count, sizeof *rest);
	struct rb_held *const held = rb_arena_take(l->arena, count, sizeof *held);
	struct rb_solver_body *const before = rb_arena_take(l->arena, members, sizeof *before);
	struct rb_drift drift = drift_of(s, ends);
	double stopped = 0;

	if (!ends || !rest || !held || !before) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for a contact");
		return;
	}
	if (!note_interleaved(s, rest))
		return;
	drift.before = held;
	drift.is_trial = true;
	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_solver_contact *c = &s->problem.contact[k];
		const rb_vec3 v = velocity_after(s, k);
		const double slip = rb_vec3_length(rb_vec3_reject(v, c->normal));

		ends[k] = fabs(rb_vec3_dot(v, c->normal)) <= rest[k];
		held[k] = (struct rb_held){.slipping = !(c->friction > 0 && slip <= rest[k])};
		if (ends[k] && !held[k].slipping)
			stopped = fmax(stopped, slip);
	}
	stopped = fmax(stopped, largest_rebound(s, ends));
	memcpy(before, s->problem.body, members * sizeof *before);
	stop_from(s, &drift, before);
	if (!(largest_change(s, before) <= stop_ratio_max * stopped)) {
		memcpy(s->problem.body, before, members * sizeof *before);
	} else if (l->account_s) { /* repeated with ledger entries */
		drift.is_trial = false;
		stop_from(s, &drift, before);
	}
}

/* Names the bodies of the fastest approach, of what driven bodies or joints leave no way out. */
static void fail_blocked(struct impact *s)
{
	struct rb_located *const l = s->l;
	double fastest = 0;
	int worst = 0;
	char label[2][64], source[96];

	for (int k = 0; k < s->contact_point_count; k++) {
		const struct rb_contact_point *const m = &s->contact_point[k];
		const double approach = -rb_vec3_dot(m->velocity, m->normal);

		if (approach > fastest) {
			fastest = approach;
			worst = k;
		}
	}
	const struct rb_scene *const scene = l->model->scene;

	if (!(fastest > 0)) { /* a limit or a rope has approached */
		const int joint = s->joints.count > 0 ? s->joints.row[0].joint : -1;
		const int def = joint >= 0 ? l->model->joints->joint[joint].def : -1;
		char joint_label[96];

		l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
		                    "%sno impulses end the approach of %s and what is joined to it "
		                    "at t = %.9g s: what is driven or held leaves no way out",
		                    def >= 0 ? rb_joint_source(scene, def, source) : "",
		                    def >= 0 ? rb_joint_label(scene, def, joint_label) : "bodies",
		                    s->t);
		return;
	}
	const int id = l->model->id_of[s->contact_point[worst].a];
	const int other = l->model->id_of[s->contact_point[worst].b];

	l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
	                    "%sno impulses end the approach of '%s' and '%s' at t = %.9g s, at "
	                    "%.3g m/s: what is driven or held leaves no way out",
	                    rb_scene_body_source(scene, id, source),
	                    rb_scene_body_label(scene, id, label[0]),
	                    rb_scene_body_label(scene, other, label[1]), s->t, fastest);
}

/*
 * Sets the body to rest if all that is left of its motion is rounding. Without weight the noise of
 * its contacts would be that of what is left, and it would be struck again and again, each time by
 * the rounding of the last impact.
 */
static void stop_rounding(const struct rb_located *l, int i, const struct rb_pose *before,
                          struct rb_solver_body *body)
{
	static const double rounding = 8 * DBL_EPSILON;
	const double reach = rb_model_reach(l->model, i);
	const double was = rb_vec3_max_abs(before->velocity) +
	                   reach * rb_vec3_max_abs(before->spin);

	if (l->weight > 0 || rb_vec3_max_abs(body->linear) > rounding * was ||
	    reach * rb_vec3_max_abs(body->angular) > rounding * was)
		return;
	body->linear = body->angular = (rb_vec3){0, 0, 0};
}

/* Solves the impact, ends series, anchors the members. */
static void collide(struct impact *s)
{
	struct rb_located *l = s->l;
	int rounds = 0;

	const bool too_many = rb_located_impact_cost(s->contact_point_count) > rb_located_left(l);
	rb_vec3 *const approach = velocities_before(s);
	if (l->status != RB_OK)
		return;
	s->problem.interrupt = &s->l->world->interrupt;
	s->problem.products_max = rb_located_products(l, s->contact_point_count);
	const bool converged = !too_many && solve_impact(s, &rounds);
	rb_located_count(l, s->problem.products, s->contact_point_count);
	if (too_many || rb_simultaneous_is_over(&s->problem)) {
		l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
		                    "%d contacts together are too many to locate",
		                    s->contact_point_count);
		return;
	}
	if (s->problem.blocked) {
		fail_blocked(s);
		return;
	}
	if (!converged)
		l->world->frame_counts.plastic_ends++;
	if (s->contact_point_count > 0)
		record_impacts(s);
	enter_impulses(s, approach);
	record_ends(s);
	end_accumulations(s);
	if (l->status == RB_OK)
		end_interleaved(s);
	for (int k = 0; k < l->set_count; k++) {
		const int i = l->set[k];

		stop_rounding(l, i, &s->pose[k], &s->problem.body[k]);
		s->pose[k].velocity = s->problem.body[k].linear;
		s->pose[k].spin = s->problem.body[k].angular;
		/* provisional: rb_resolve_contacts finds their forces */
		rb_arc_anchor(l, i, s->t, &s->pose[k], rb_arc_acceleration(l, i, s->t),
		              (rb_vec3){0, 0, 0});
	}
}

/* Resolves one simultaneous impact; returns the rounding error of velocities after it, m/s. */
static double collide_once(struct rb_located *l, int a, int b, double t)
{
	struct impact s = {.l = l, .t = t};
	const rb_arena_mark here = rb_arena_here(l->arena);

	rb_event_set_add(l, a);
	rb_event_set_add(l, b);
	/* a joint's limit or rope is no pair's impact */
	l->touch_a = a == b ? -1 : a;
	l->touch_b = a == b ? -1 : b;
	s.contact_point_count = rb_event_set_grow(l, t, 0, rb_event_set_touching, &s.contact_point);
	if (s.contact_point_count < 0 || !build(&s))
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for an impact of %d bodies",
		                    l->set_count);
	else
		collide(&s);
	rb_arena_back(l->arena, here);
	return s.slack;
}

void rb_resolve_impacts(struct rb_located *l, int a, int b, double t)
{
	RB_ASSERT(rb_located_is_body(l, a) && rb_located_is_body(l, b));

	int hit[2] = {a, b};
	bool more = true;

	/* a rim's lowest point converges like a root, with twice the digits each round */
	for (int round = 0; more; round++) {
		const double slack = collide_once(l, hit[0], hit[1], t);

		more = l->status == RB_OK &&
		       !rb_resolve_contacts(l, t, true, slack, round < ROUNDS_MAX ? hit : NULL);
	}
	l->touch_a = l->touch_b = -1;
}
