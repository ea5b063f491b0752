/* SPDX-License-Identifier: MIT */
#include "located/joint_drives.h"

#include <float.h>

#include "located/arc.h"
#include "located/follow.h"

/* Rounding of a rate and of an angle, in ulp of the terms that they are differences of. */
enum { DRIVE_ULP = 64, ANGLE_ULP = 16 };
/*
 * A drive that reaches its speed within this many ulp of the size is at it. Of 59 chains whose
 * motors drive them into stops (tests/random/stops.lua) 8 had no end without; with 16, 64 or 256
 * ulp all but two or three come to theirs in 4 s of processor time.
 */
enum { SOON_ULP = 256 };
/* Rounding of time in ulp: shorter pieces have no length. */
enum { AT_ONCE_ULP = 2 };
/* Share of its bound by which the solver may leave a force below it. */
static const double within_bound = 1e-11;

static signed char *mode_of(const struct rb_joint_rows *rows, int joint, int kind)
{
	return &rows->l->drive_mode[RB_JOINT_PARTS_HELD * joint + kind];
}

static struct rb_linkage_free free_of(const struct rb_joint_rows *rows, int joint_index, double t)
{
	struct rb_pose end[2];

	rb_joint_rows_ends(rows, joint_index, t, end);
	return rb_linkage_free(&rows->l->model->joints->joint[joint_index].link, &end[0], &end[1]);
}

/* Sum of the rates whose difference is the rate of a free coordinate, m/s or rad/s. */
static double rates_of(const struct rb_joint_rows *rows, int joint_index, double t)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[joint_index];
	struct rb_pose end[2];

	rb_joint_rows_ends(rows, joint_index, t, end);
	const double spin = rb_vec3_length(end[0].spin) + rb_vec3_length(end[1].spin);

	if (rb_linkage_turns(&joint->link))
		return spin;
	return rb_vec3_length(end[0].velocity) + rb_vec3_length(end[1].velocity) +
	       spin * joint->size;
}

double rb_joint_drives_noise(const struct rb_joint_rows *rows, int joint_index, double t)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[joint_index];
	const double fall = rb_joint_rows_fall(rows->l, joint_index);

	return DRIVE_ULP * DBL_EPSILON *
	       (rates_of(rows, joint_index, t) +
	        (rb_linkage_turns(&joint->link) ? fall / joint->size : fall));
}

struct rb_joint_off rb_joint_drives_off(const struct rb_joint_rows *rows, int joint_index, double t)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const struct rb_linkage_free free = free_of(rows, joint_index, t);
	const struct rb_follow_point to = rb_follow_at(l, joint_index, t, false);
	const double value = rb_joint_state_angle(&l->world->joint[joint_index], &joint->link, t,
	                                          &free);
	const double size = rb_linkage_turns(&joint->link) ? 1 : joint->size;
	const double lever = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const double reach = fmax(size, fmax(fabs(value), fabs(to.value)));

	return (struct rb_joint_off){.value = value - to.value,
	                             .rate = free.rate - to.rate,
	                             .band = ANGLE_ULP * DBL_EPSILON * (reach + t * fabs(to.rate)),
	                             .noise = rb_joint_drives_noise(rows, joint_index, t) +
	                                      to.noise,
	                             .lever = lever,
	                             .reach = reach,
	                             .speed = rates_of(rows, joint_index, t) + to.speed_max};
}

/*
 * Mode of a stop: if it touches and neither opens nor approaches, it may hold, depending on its
 * force.
 */
static void begin_stop(const struct rb_joint_rows *rows, int joint_index, int stop, double t,
                       bool jumped, double slack)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[joint_index];
	signed char *const mode = mode_of(rows, joint_index, stop);

	if (!rb_joint_rows_has_stop(joint, stop) || (*mode == RB_DRIVE_HELD && !jumped))
		return;
	const struct rb_joint_stop now = rb_joint_rows_stop(rows, joint_index, stop, t);
	const double scale = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const bool touches = *mode == RB_DRIVE_REACHED || now.gap <= now.band;

	/* a stop that was just found to rise by less than rounding does not open */
	const bool rises = *mode == RB_DRIVE_REACHED && now.rate > 0;

	*mode = touches && (rises || fabs(now.rate) <= now.noise + slack / scale) ? RB_DRIVE_HELD
	                                                                          : RB_STOP_OPEN;
}

/* Has the piece reached its end, where a drive is at its speed, or was it cut before? */
static bool has_ended(const struct rb_located *l, int joint_index, double t)
{
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const int body = rb_located_fixed(l, joint->a) ? joint->b : joint->a;

	return !rb_located_on_piece(l, body) || t >= l->piece[body].until_s;
}

/*
 * Has the piece ended at its beginning? A drive that it has found to exceed its bound there does
 * so, whatever the solver says: their forces differ by the rounding of loads that cancel.
 */
static bool has_ended_at_once(const struct rb_located *l, int joint_index, double t)
{
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const int body = rb_located_fixed(l, joint->a) ? joint->b : joint->a;
	const double fall = rb_joint_rows_fall(l, joint_index);
	const double natural_s = fall > 0 ? joint->size / fall : 0;

	return rb_located_on_piece(l, body) &&
	       t - l->piece[body].origin_s <= AT_ONCE_ULP * DBL_EPSILON * fmax(t, natural_s);
}

/*
 * Applies the mode changes of a piece's end, if the piece has reached it. `sure`: whether a drive
 * is known to be at its bound.
 */
static void take_next(const struct rb_joint_rows *rows, int joint_index, double t,
                      bool sure[RB_JOINT_PARTS_HELD])
{
	struct rb_located *l = rows->l;

	for (int part = 0; part < RB_JOINT_PARTS_HELD; part++) {
		signed char *const next = &l->drive_next[RB_JOINT_PARTS_HELD * joint_index + part];
		const bool changes = *next != RB_DRIVE_KEEPS && has_ended(l, joint_index, t);

		sure[part] = changes && *mode_of(rows, joint_index, part) == RB_DRIVE_HELD &&
		             has_ended_at_once(l, joint_index, t);
		/* a mode set by keep_on had no time to act */
		if (part == RB_DRIVE_MOTOR && *next == *mode_of(rows, joint_index, part) &&
		    has_ended_at_once(l, joint_index, t))
			continue;
		if (changes)
			*mode_of(rows, joint_index, part) = *next;
		*next = RB_DRIVE_KEEPS;
	}
}

/* Mode of a drive that holds a speed. */
static void begin_drive(const struct rb_joint_rows *rows, int joint_index, int kind, double t,
                        bool jumped)
{
	signed char *const mode = mode_of(rows, joint_index, kind);
	const double v = free_of(rows, joint_index, t).rate -
	                 rb_joint_rows_drive_now(rows->l, joint_index, kind).speed;

	if ((!jumped && (*mode == RB_DRIVE_HELD || *mode == RB_DRIVE_REACHED)) ||
	    fabs(v) <= rb_joint_drives_noise(rows, joint_index, t))
		*mode = RB_DRIVE_HELD;
	else
		*mode = v < 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
}

bool rb_joint_drives_stopped(const struct rb_located *l, int joint_index)
{
	const signed char *const mode = &l->drive_mode[RB_JOINT_PARTS_HELD * joint_index];
	bool any = false;

	for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++)
		any = any || (mode[stop] == RB_DRIVE_HELD &&
		              rb_joint_rows_has_stop(&l->model->joints->joint[joint_index], stop));
	return any;
}

/*
 * A motor that cannot return with the forces that act now must not try again at once: the next
 * piece keeps its mode, even if braking would suffice.
 */
static void keep_on(const struct rb_joint_rows *rows, int joint_index)
{
	rows->l->drive_next[RB_JOINT_PARTS_HELD * joint_index + RB_DRIVE_MOTOR] = *mode_of(
		rows, joint_index, RB_DRIVE_MOTOR);
}

/*
 * Mode of a motor that follows. If held, it remains so in spite of drift in the piece, except after
 * jumps: of the followed motion, or by an impact. At a bound it remains while it pushes towards the
 * followed motion, or brakes.
 */
static void begin_follow(const struct rb_joint_rows *rows, int joint_index, double t, bool jumped,
                         double slack)
{
	struct rb_located *l = rows->l;
	signed char *const mode = mode_of(rows, joint_index, RB_DRIVE_MOTOR);
	const bool kept = *mode == RB_DRIVE_HELD, jumps = rb_follow_begin(l, joint_index, t);

	if (l->status != RB_OK || (kept && !jumps && !jumped))
		return;
	const struct rb_joint_off off = rb_joint_drives_off(rows, joint_index, t);
	const struct rb_follow_point on = rb_follow_at(l, joint_index, t, true);
	const struct rb_follow_point to = rb_follow_at(l, joint_index, t, false);
	/* while it returns, the deviation is from the planned return */
	const double e = off.value - (kept ? on.value - to.value : 0);
	const double v = off.rate - (kept ? on.rate - to.rate : 0);
	const double share = kept ? rb_joint_drift_max : 0;
	const double noise = off.noise + (jumped ? slack / off.lever : 0);

	if (fabs(e) <= fmax(off.band, share * off.reach) &&
	    fabs(v) <= fmax(noise, jumps ? share * off.speed : 0)) {
		*mode = RB_DRIVE_HELD;
		return;
	}
	rb_follow_end_return(l, joint_index);
	if (*mode == RB_DRIVE_REACHED && !jumped && !rb_joint_drives_stopped(l, joint_index) &&
	    rb_follow_converges(off.value, off.rate)) {
		rb_follow_begin_return(l, joint_index, t, off.value, off.rate);
		*mode = RB_DRIVE_HELD;
	} else if ((*mode != RB_DRIVE_LOW && *mode != RB_DRIVE_HIGH) || jumped ||
	           rb_joint_off_ends(&off, *mode)) {
		const double towards = fabs(off.value) > off.band ? off.value : off.rate;
		const bool cannot_return = *mode == RB_DRIVE_REACHED && !jumped;

		*mode = towards < 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
		if (cannot_return)
			keep_on(rows, joint_index);
	}
}

static void follow(const struct rb_joint_rows *rows, int joint_index, double t, bool jumped,
                   double slack)
{
	begin_follow(rows, joint_index, t, jumped, slack);
	if (*mode_of(rows, joint_index, RB_DRIVE_MOTOR) == RB_DRIVE_HELD)
		rows->l->drive_next[RB_JOINT_PARTS_HELD * joint_index + RB_DRIVE_MOTOR] =
			RB_DRIVE_KEEPS;
}

void rb_joint_drives_begin(const struct rb_joint_rows *rows, double t, bool jumped, double slack)
{
	for (int k = 0; k < rows->joint_count; k++) {
		const int joint_index = rows->joint[k];
		bool sure[RB_JOINT_PARTS_HELD];

		take_next(rows, joint_index, t, sure);
		for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++)
			begin_stop(rows, joint_index, stop, t, jumped, slack);
		for (int kind = 0;
		     kind < RB_JOINT_DRIVES && rb_joint_rows_has_drive(rows->l, joint_index);
		     kind++) {
			if (kind == RB_DRIVE_MOTOR && rb_follow_has(rows->l, joint_index))
				follow(rows, joint_index, t, jumped, slack);
			else if (jumped || !sure[kind])
				begin_drive(rows, joint_index, kind, t, jumped);
		}
	}
}

/* Were velocities set, by the scene or a callback, where drives or stops may hold? */
static bool may_not_fit(const struct rb_joint_rows *rows)
{
	const struct rb_located *l = rows->l;
	bool set = l->starting, holds = false;

	for (int k = 0; k < rows->joint_count; k++) {
		const int joint_index = rows->joint[k];
		const struct rb_joint *joint = &l->model->joints->joint[joint_index];

		set = set || l->world->joint[joint_index].was_set;
		holds = holds || rb_joint_rows_has_drive(l, joint_index) ||
		        rb_joint_rows_has_stop(joint, RB_STOP_LOW) ||
		        rb_joint_rows_has_stop(joint, RB_STOP_HIGH);
	}
	return set && holds;
}

/* Is there a velocity that joints do not allow? What stands is not to be moved by its rounding. */
static bool is_off(const struct rb_joint_rows *rows)
{
	bool off = false;

	for (int k = 0; k < rows->count; k++)
		off = off || (rows->row[k].drive < 0 && rows->row[k].velocity != 0);
	return off;
}

void rb_joint_drives_fit(struct rb_joint_rows *rows, double t, struct rb_pose *pose)
{
	struct rb_located *l = rows->l;
	const rb_arena_mark here = rb_arena_here(l->arena);
	const size_t count = (size_t)rows->joint_count * RB_JOINT_PARTS_HELD;

	if (!may_not_fit(rows))
		return;
	signed char *const kept = rb_arena_take(l->arena, count, 1);
	if (!kept) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for joints");
		return;
	}
	for (size_t at = 0; at < count; at++) {
		const int part = (int)(at % RB_JOINT_PARTS_HELD);
		signed char *const mode = mode_of(rows, rows->joint[at / RB_JOINT_PARTS_HELD],
		                                  part);

		kept[at] = *mode;
		*mode = part < RB_JOINT_DRIVES ? RB_DRIVE_LOW : RB_STOP_OPEN;
	}
	rb_joint_rows_fill(rows, t);
	if (is_off(rows))
		rb_joint_rows_correct(rows, t, pose, true);
	for (size_t at = 0; at < count; at++)
		*mode_of(rows, rows->joint[at / RB_JOINT_PARTS_HELD],
		         (int)(at % RB_JOINT_PARTS_HELD)) = kept[at];
	rb_arena_back(l->arena, here);
}

void rb_joint_drives_turn(struct rb_joint_rows *rows, double t, bool moved)
{
	bool any = false;

	for (int k = 0; k < rows->joint_count && moved; k++)
		for (int kind = 0; kind < RB_JOINT_DRIVES; kind++) {
			const int joint_index = rows->joint[k];
			const signed char was = *mode_of(rows, joint_index, kind);

			if (!rb_joint_rows_has_drive(rows->l, joint_index) ||
			    (kind == RB_DRIVE_MOTOR && rb_follow_has(rows->l, joint_index)) ||
			    (was != RB_DRIVE_LOW && was != RB_DRIVE_HIGH))
				continue;
			begin_drive(rows, joint_index, kind, t, true);
			any = any || *mode_of(rows, joint_index, kind) != was;
		}
	if (any)
		rb_joint_rows_fill(rows, t);
}

double rb_joint_drives_soon(const struct rb_located *l, int joint_index, int kind, double *impulse)
{
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	const double lever = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const double force = rb_joint_rows_drive_now(l, joint_index, kind).max / lever;
	const int end[2] = {joint->a, joint->b};
	double inverse = 0;

	for (int e = 0; e < 2; e++)
		if (end[e] >= 0 && !rb_located_fixed(l, end[e]))
			inverse += l->model->inverse_mass[end[e]];
	const double speed = sqrt(2 * inverse * force * SOON_ULP * DBL_EPSILON * joint->size);

	if (impulse)
		*impulse = inverse > 0 ? speed / inverse : 0;
	return speed / lever;
}

bool rb_joint_drives_end(const struct rb_joint_rows *rows, double t, double slack)
{
	bool any = false;

	rb_joint_drives_begin(rows, t, true, slack);
	for (int k = 0; k < rows->joint_count; k++)
		for (int kind = 0; kind < RB_JOINT_DRIVES; kind++) {
			const int joint_index = rows->joint[k];
			const struct rb_joint_drive drive = rb_joint_rows_drive_now(
				rows->l, joint_index, kind);
			signed char *const mode = mode_of(rows, joint_index, kind);

			if (!(drive.max > 0) || isnan(drive.speed) || *mode == RB_DRIVE_HELD ||
			    !(fabs(free_of(rows, joint_index, t).rate - drive.speed) <=
			      rb_joint_drives_soon(rows->l, joint_index, kind, NULL)))
				continue;
			*mode = RB_DRIVE_HELD;
			any = true;
		}
	return any;
}

/* Multiplier of the row of that part; 0: it has none. */
static double multiplier_of(const struct rb_joint_rows *rows, const double *multiplier,
                            int joint_index, int part)
{
	for (int k = 0; k < rows->count; k++)
		if (rows->row[k].joint == joint_index && rows->row[k].drive == part)
			return multiplier[k];
	return 0;
}

/*
 * A stop and a motor that follows a moving target cannot both hold: their rows are the same, with
 * different right sides. If the motor moves away from the stop, with the sum of both forces within
 * its bound, the stop is open; otherwise the motor is at its bound, in the direction of the motion.
 */
static void separate_from_stop(const struct rb_joint_rows *rows, const double *multiplier,
                               int joint_index, int stop, double t)
{
	struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[joint_index];
	signed char *const motor = mode_of(rows, joint_index, RB_DRIVE_MOTOR);

	if (!rb_joint_rows_has_stop(joint, stop) ||
	    *mode_of(rows, joint_index, stop) != RB_DRIVE_HELD || *motor != RB_DRIVE_HELD ||
	    !rb_follow_has(l, joint_index) || !rb_follow_moves(l, joint_index))
		return;
	const struct rb_follow_point to = rb_follow_at(l, joint_index, t, true);
	const double sign = stop == RB_STOP_LOW ? 1 : -1;
	const double target_motion = fabs(to.rate) > to.noise ? to.rate : to.acceleration;
	const double scale = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const double bound = rb_joint_rows_drive_now(l, joint_index, RB_DRIVE_MOTOR).max / scale;
	const double sum = sign * multiplier_of(rows, multiplier, joint_index, RB_DRIVE_MOTOR) +
	                   multiplier_of(rows, multiplier, joint_index, stop);

	if (sign * target_motion > 0 && sum <= bound) {
		*mode_of(rows, joint_index, stop) = RB_STOP_OPEN;
		return;
	}
	*motor = target_motion > 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
	rb_follow_end_return(l, joint_index);
}

void rb_joint_drives_decide(const struct rb_joint_rows *rows, const double *multiplier, double t)
{
	for (int k = 0; k < rows->count; k++) {
		const struct rb_joint_row *row = &rows->row[k];

		if (rb_joint_rows_is_stop(row) && !(multiplier[k] > 0))
			*mode_of(rows, row->joint, row->drive) = RB_STOP_OPEN;
		if (row->drive < 0 ||
		    fabs(multiplier[k]) < rb_joint_rows_bound(rows, row) * (1 - within_bound))
			continue;
		*mode_of(rows, row->joint, row->drive) = multiplier[k] > 0 ? RB_DRIVE_HIGH
		                                                           : RB_DRIVE_LOW;
		if (row->drive != RB_DRIVE_MOTOR)
			continue;
		if (rb_follow_has(rows->l, row->joint) &&
		    rb_follow_is_returning(rows->l, row->joint))
			keep_on(rows, row->joint);
		rb_follow_end_return(rows->l, row->joint);
	}
	for (int k = 0; k < rows->joint_count; k++)
		for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++)
			separate_from_stop(rows, multiplier, rows->joint[k], stop, t);
}
