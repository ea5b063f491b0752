/* SPDX-License-Identifier: MIT */
#include "located/joint_stops.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "located/arc.h"
#include "located/external_force.h"
#include "located/follow.h"
#include "world/joint_events.h"

/* Height of the smallest rebound, in ulp of the joint's size. */
enum { SMALLEST_ULP = 8 };
/*
 * Limit of a drive's impulse, in multiples of that which changes a body's speed by what the drive
 * would soon correct: it may hold a heavier mass. Bounded, because stops may act against it.
 */
enum { HEAVIER_MAX = 16 };
/*
 * Least share of a row's own response that joints must leave: forces round by an ulp, and their
 * effects on possible motions by that over this share.
 */
enum { SHARE_ULP = 1 << 10 };

static bool fail_memory(const struct rb_joint_rows *rows)
{
	struct rb_located *l = rows->l;

	if (l->status == RB_OK)
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for the joints of %d bodies",
		                    rows->body_count);
	return false;
}

int rb_joint_stops_hit(const struct rb_joint_rows *rows, double t, double slack)
{
	for (int k = 0; k < rows->joint_count; k++) {
		const int joint_index = rows->joint[k];
		const struct rb_joint *joint = &rows->l->model->joints->joint[joint_index];
		const signed char *mode = &rows->l->drive_mode[RB_JOINT_PARTS_HELD * joint_index];
		/* residual velocities of stopped bodies are rounding of those before the impact */
		const double residual = slack / (rb_linkage_turns(&joint->link) ? joint->size : 1);

		for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++) {
			if (!rb_joint_rows_has_stop(joint, stop) ||
			    (mode[stop] == RB_DRIVE_HELD && !rows->l->starting))
				continue;
			const struct rb_joint_stop now = rb_joint_rows_stop(rows, joint_index, stop,
			                                                    t);

			if (now.gap <= now.band && now.rate < -(now.noise + residual))
				return joint_index;
		}
	}
	return -1;
}

/* ---- dependent stops ---- */

/*
 * Share of a row's own response that joints leave. Projected twice: the first time leaves rounding
 * of what it removes.
 */
static double independent_share(struct rb_joint_hold *hold, const struct rb_joint_row *row,
                                rb_vec3 *linear, rb_vec3 *angular)
{
	const size_t bodies = (size_t)hold->rows.body_count;
	struct rb_coupled_row coupled = rb_joint_rows_coupled(row);

	memset(linear, 0, bodies * sizeof *linear);
	memset(angular, 0, bodies * sizeof *angular);
	rb_coupled_respond(&hold->system, &coupled);
	rb_coupled_add(&coupled, 1, linear, angular);
	const double all = rb_coupled_rate(&coupled, linear, angular);

	for (int round = 0; round < 2; round++)
		rb_joint_hold_apply(hold, linear, angular);
	return all > 0 ? rb_coupled_rate(&coupled, linear, angular) / all : 1;
}

/* Fails because of a stop that is hit although it is eased. */
static void fail_by(const struct rb_joint_rows *rows, int joint_index, double t)
{
	struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	char label[96], source[96];

	l->status = RB_FAIL(l->err, RB_ERR_PHYSICS,
	                    "%s%s cannot stop what it joins at t = %.17g s: it is across to all "
	                    "that may move, which exceeds it by more than 5e-10 of its size, "
	                    "%.3g m",
	                    rb_joint_source(l->model->scene, joint->def, source),
	                    rb_joint_label(l->model->scene, joint->def, label), t, joint->size);
}

/* Eases the touching stops whose independent share is below that of easing. */
static bool ease(const struct rb_joint_rows *touching, double t)
{
	struct rb_located *l = touching->l;
	const size_t bodies = (size_t)touching->body_count;
	rb_vec3 *const linear = rb_arena_take(l->arena, 2 * bodies, sizeof *linear);
	struct rb_joint_hold hold = {.rows = {.count = -1}};

	for (int k = 0; linear && k < touching->count; k++) {
		const struct rb_joint_row *row = &touching->row[k];
		const int part = RB_JOINT_PARTS_HELD * row->joint + row->drive;

		if (!rb_joint_rows_is_stop(row))
			continue;
		const struct rb_joint_stop now = rb_joint_rows_stop(touching, row->joint,
		                                                    row->drive, t);

		if (now.gap > now.band || (l->eased[part] && now.rate >= -now.noise))
			continue;
		if (hold.rows.count < 0 && !rb_joint_hold_take(&hold, l, touching->pose, t, true))
			return false;
		if (hold.rows.count == 0)
			break;
		const double share = independent_share(&hold, row, linear, linear + bodies);

		if (l->eased[part]) {
			if (share < SHARE_ULP * DBL_EPSILON)
				fail_by(touching, row->joint, t);
		} else if (share < rb_joint_eased) {
			l->eased[part] = true;
			l->drive_mode[part] = RB_STOP_OPEN;
		}
	}
	return linear != NULL;
}

/* Restores eased stops that are open without it. */
static void end_ease(const struct rb_joint_rows *rows, double t)
{
	for (int k = 0; k < rows->joint_count; k++)
		for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++) {
			const int joint_index = rows->joint[k],
				  part = RB_JOINT_PARTS_HELD * joint_index + stop;

			if (!rows->l->eased[part] || rows->l->drive_mode[part] == RB_DRIVE_HELD)
				continue;
			const struct rb_joint_stop now = rb_joint_rows_stop(rows, joint_index, stop,
			                                                    t);

			rows->l->eased[part] = now.gap - rb_joint_rows_eased(rows->l, joint_index,
			                                                     stop) <=
			                       now.band;
		}
}

void rb_joint_stops_ease(const struct rb_joint_rows *rows, double t)
{
	const rb_arena_mark here = rb_arena_here(rows->l->arena);
	struct rb_joint_rows touching = *rows;

	touching.touching = true;
	end_ease(rows, t);
	if (rb_joint_rows_collect(&touching)) {
		rb_joint_rows_fill(&touching, t);
		if (!ease(&touching, t))
			fail_memory(rows);
	} else {
		fail_memory(rows);
	}
	rb_arena_back(rows->l->arena, here);
}

int rb_joint_stops_body(const struct rb_located *l, int joint_index)
{
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];

	return rb_located_fixed(l, joint->a) ? joint->b : joint->a;
}

/* ---- rebounds that end ---- */

/* Accelerations by place at the rows' poses, by everything except contacts. */
static bool accelerate(struct rb_joint_rows *rows, double t, rb_vec3 *linear, rb_vec3 *angular)
{
	const struct rb_force_query view = {
		.pose = rows->pose, .time_s = t, .active_s = t, .attracted = true};

	rb_external_attract(rows->l, &view);
	for (int p = 0; p < rows->body_count; p++)
		rb_external_force_at(rows->l, rows->body[p], &rows->pose[p], &view, &linear[p],
		                     &angular[p]);
	rb_joint_drives_begin(rows, t, true, 0);
	rb_joint_rows_fill(rows, t);
	rb_joint_rows_add_springs(rows, t, linear, angular);
	return rows->count == 0 || rb_joint_rows_accelerate(rows, linear, angular);
}

/* The row of the same part of the same joint; NULL: there is none. */
static const struct rb_joint_row *matching_row(const struct rb_joint_rows *rows,
                                               const struct rb_joint_row *key)
{
	for (int k = 0; k < rows->count; k++)
		if (rows->row[k].joint == key->joint && rows->row[k].drive == key->drive)
			return &rows->row[k];
	return NULL;
}

/*
 * Does the series of rebounds that begins with the row's velocity end within rounding? `pressed`,
 * m/s^2: bound of the acceleration by contacts, whose forces are not known yet.
 */
static bool ends_here(const struct rb_joint_rows *after, const struct rb_joint_row *row,
                      const rb_vec3 *linear, const rb_vec3 *angular, double pressed)
{
	const struct rb_joint *joint = &after->l->model->joints->joint[row->joint];
	const struct rb_coupled_row coupled = rb_joint_rows_coupled(row);
	const double closing = fmax(-(rb_coupled_rate(&coupled, linear, angular) + row->bias),
	                            pressed);

	return row->velocity > 0 && closing > 0 &&
	       row->velocity * row->velocity <=
	               2 * closing * SMALLEST_ULP * DBL_EPSILON * joint->size;
}

/* The problem's next row of a stop; these are in the order of ours. */
static struct rb_cone_row *next_stop(const struct rb_simultaneous *problem, int *at)
{
	while (*at < problem->joint_count && rb_constraint_side(&problem->joint_row[*at].base) <= 0)
		++*at;
	return *at < problem->joint_count ? &problem->joint_row[(*at)++] : NULL;
}

static bool end_rebounds(const struct rb_joint_rows *rows, const struct rb_simultaneous *problem,
                         double t)
{
	struct rb_arena *arena = rows->l->arena;
	const size_t bodies = (size_t)rows->body_count;
	struct rb_pose *const pose = rb_arena_take(arena, bodies + 1, sizeof *pose);
	rb_vec3 *const linear = rb_arena_take(arena, 2 * bodies + 1, sizeof *linear);
	struct rb_joint_rows after = *rows;
	double pressed = 0;
	int at = 0;
	bool any = false;

	after.pose = pose;
	after.touching = false;
	if (!pose || !linear || !rb_joint_rows_collect(&after))
		return fail_memory(rows);
	for (size_t p = 0; p < bodies; p++) {
		pose[p] = rows->pose[p];
		pose[p].velocity = problem->body[p].linear;
		pose[p].spin = problem->body[p].angular;
	}
	if (!accelerate(&after, t, linear, linear + bodies))
		return false;
	for (size_t p = 0; p < bodies && problem->contact_count > 0; p++)
		pressed = fmax(pressed, rb_vec3_max_abs(linear[p]));
	after.touching = true;
	rb_joint_rows_fill(&after, t);
	for (int k = 0; k < rows->count; k++) {
		if (!rb_joint_rows_is_stop(&rows->row[k]))
			continue;
		struct rb_cone_row *const stop = next_stop(problem, &at);
		const struct rb_joint_row *row = matching_row(&after, &rows->row[k]);

		if (!(stop->approach > 0) || !(stop->restitution > 0) || !row ||
		    !ends_here(&after, row, linear, linear + bodies, pressed))
			continue;
		rows->row[k].restitution = stop->restitution = 0;
		any = true;
	}
	return any;
}

bool rb_joint_stops_end(const struct rb_joint_rows *rows, const struct rb_simultaneous *problem,
                        double t)
{
	const rb_arena_mark here = rb_arena_here(rows->l->arena);
	bool any = false;

	for (int k = 0; k < rows->count; k++)
		any = any || rb_joint_rows_is_stop(&rows->row[k]);
	any = any && end_rebounds(rows, problem, t);
	rb_arena_back(rows->l->arena, here);
	return any;
}

/* The row's velocity after the impact, m/s. */
static double velocity_after(const struct rb_joint_rows *rows, const struct rb_joint_row *row,
                             const struct rb_simultaneous *problem)
{
	const struct rb_coupled_wrench *const wrench = &row->wrench;
	double sum = row->velocity;

	for (int on_b = 0; on_b < 2; on_b++) {
		const int place = on_b ? row->b : row->a;

		if (place < 0)
			continue;
		const rb_vec3 linear = rb_vec3_sub(problem->body[place].linear,
		                                   rows->pose[place].velocity);
		const rb_vec3 angular = rb_vec3_sub(problem->body[place].angular,
		                                    rows->pose[place].spin);

		sum += (on_b ? 1 : -1) * rb_vec3_dot(wrench->linear, linear) +
		       rb_vec3_dot(on_b ? wrench->angular_b : wrench->angular_a, angular);
	}
	return sum;
}

bool rb_joint_stops_include(const struct rb_joint_rows *rows, const struct rb_simultaneous *problem)
{
	bool any = false;

	for (int k = 0; k < rows->count; k++) {
		struct rb_joint_row *const row = &rows->row[k];

		if (row->drive < 0 || rb_joint_rows_is_stop(row) || row->impulse_max > 0)
			continue;
		const double off = fabs(velocity_after(rows, row, problem)) / row->scale;
		double impulse;

		if (!(off > 0) ||
		    off > rb_joint_drives_soon(rows->l, row->joint, row->drive, &impulse))
			continue;
		row->impulse_max = HEAVIER_MAX * impulse;
		any = true;
	}
	return any;
}

void rb_joint_stops_end_drives(const struct rb_joint_rows *rows, struct rb_simultaneous *problem,
                               struct rb_pose *pose, double t, double slack)
{
	const rb_arena_mark here = rb_arena_here(rows->l->arena);
	struct rb_joint_rows after = *rows;

	RB_ASSERT(rows->pose == pose);
	after.touching = false;
	for (int p = 0; p < rows->body_count; p++) {
		pose[p].velocity = problem->body[p].linear;
		pose[p].spin = problem->body[p].angular;
	}
	if (!rb_joint_rows_collect(&after)) {
		fail_memory(rows);
		return;
	}
	if (rb_joint_drives_end(&after, t, slack))
		rb_joint_rows_correct(&after, t, pose, true);
	for (int p = 0; p < rows->body_count; p++) {
		problem->body[p].linear = pose[p].velocity;
		problem->body[p].angular = pose[p].spin;
	}
	rb_arena_back(rows->l->arena, here);
}

/* ---- events and ledger ---- */

static struct rb_pose pose_of(const struct rb_joint_rows *rows, int body, double t)
{
	if (body < 0)
		return rb_linkage_world();
	if (body < rows->l->n && rows->l->place[body] >= 0)
		return rows->pose[rows->l->place[body]];
	return rb_arc_pose(rows->l, body, t);
}

static void add_event(const struct rb_joint_rows *rows, enum rb_event_kind kind, int joint_index,
                      double impulse, double approach, double t)
{
	struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const struct rb_joint_moment moment = {.joint = joint_index,
	                                       .time_s = t,
	                                       .a = pose_of(rows, joint->a, t),
	                                       .b = pose_of(rows, joint->b, t)};
	const struct rb_event event = rb_joint_event(l->model, kind, &moment, impulse, approach);
	const enum rb_status status = rb_world_add_event(l->world, &event, l->err);

	if (l->status == RB_OK)
		l->status = status;
}

/*
 * Adds the energy that stops have taken by impulses [rows->count], and records the stops that were
 * hit.
 */
static void enter_stops(const struct rb_joint_rows *rows, const struct rb_simultaneous *problem,
                        const double *impulse, double t, struct rb_entries *e)
{
	const struct rb_located *l = rows->l;
	int at = 0;

	for (int k = 0; k < rows->count; k++) {
		const struct rb_joint_row *row = &rows->row[k];

		if (!rb_joint_rows_is_stop(row))
			continue;
		const struct rb_cone_row *stop = next_stop(problem, &at);
		const struct rb_solver_bodies bodies = rb_simultaneous_bodies(problem);
		const rb_vec3 u = rb_vec3_add(rb_constraint_velocity(&bodies, &stop->base),
		                              stop->bias);
		const double after = rb_vec3_dot(u, stop->base.normal);
		const bool rope = l->model->joints->joint[row->joint].link.type->one_sided;
		const double sign = row->drive == RB_STOP_LOW ? 1 : -1;

		rb_entries_energy(e, RB_ENERGY_IMPACTS,
		                  -0.5 * impulse[k] * (row->velocity + after));
		if (stop->approach > 0)
			add_event(rows, rope ? RB_EVENT_TAUT : RB_EVENT_LIMIT, row->joint,
			          sign * impulse[k] * row->scale, stop->approach / row->scale, t);
	}
}

void rb_joint_stops_enter_impact(const struct rb_joint_rows *rows,
                                 const struct rb_simultaneous *problem, double t)
{
	struct rb_located *l = rows->l;
	struct rb_entries e = {0};
	double *const impulse = rb_arena_take(l->arena, (size_t)rows->count, sizeof *impulse);

	if (!impulse) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for an impact");
		return;
	}
	rb_joint_rows_read_problem(rows, false, problem->joint_row, impulse);
	enter_stops(rows, problem, impulse, t, &e);
	for (int k = 0; k < rows->count; k++) {
		const struct rb_joint_row *row = &rows->row[k];

		/*
		 * by the mean of J V before and after: zero, except for a scene's initial
		 * velocities
		 */
		if (!rb_joint_rows_is_stop(row))
			rb_entries_energy(
				&e, RB_ENERGY_IMPACTS,
				-0.5 * impulse[k] *
					(row->velocity +
			                 (row->impulse_max > 0 ? velocity_after(rows, row, problem)
			                                       : 0)));
		rb_entries_energy(&e, RB_ENERGY_DRIVEN, impulse[k] * row->speed);
		rb_joint_rows_enter(rows, row, impulse[k], t, &e);
	}
	if (l->account_s)
		rb_ledger_enter(&l->world->ledger, &e);
}

void rb_joint_stops_note(const struct rb_joint_rows *rows, double t)
{
	const struct rb_located *l = rows->l;

	for (int k = 0; k < rows->joint_count; k++) {
		const int joint_index = rows->joint[k];
		const signed char *mode = &l->drive_mode[RB_JOINT_PARTS_HELD * joint_index];
		int *const noted = l->world->joint[joint_index].noted;
		enum rb_event_kind kind;

		for (int drive = 0; drive < RB_JOINT_DRIVES; drive++) {
			const bool back = drive == RB_DRIVE_MOTOR &&
			                  rb_follow_is_returning(l, joint_index);

			if (rb_joint_rows_drive_now(l, joint_index, drive).max > 0 &&
			    rb_joint_event_notes(noted, drive,
			                         mode[drive] == RB_DRIVE_HELD && !back, &kind))
				add_event(rows, kind, joint_index, 0, 0, t);
		}
		if (rb_joint_rows_has_stop(&l->model->joints->joint[joint_index], RB_STOP_HIGH) &&
		    l->model->joints->joint[joint_index].link.type->one_sided &&
		    rb_joint_event_notes(noted, RB_JOINT_TAUT, mode[RB_STOP_HIGH] == RB_DRIVE_HELD,
		                         &kind))
			add_event(rows, kind, joint_index, 0, 0, t);
	}
}
