/* SPDX-License-Identifier: MIT */
#include "located/joint_drives.h"

#include <float.h>

#include "located/arc.h"
#include "located/follow.h"

/* Rounding of a rate and of an angle, in ulp of what they are differences of. */
enum { DRIVE_ULP = 64, ANGLE_ULP = 16 };
/* Ulp of the size, within which a drive that comes to its speed is at it. */
enum { SOON_ULP = 256 };
/* Of time: a piece within it has no length. */
enum { AT_ONCE_ULP = 2 };
/* Share of its bound by which the solver may leave a force that is at it below. */
static const double within_bound = 1e-11;

static signed char *mode_of(const struct rb_joint_rows *rows, int joint, int kind)
{
	return &rows->l->drive_mode[RB_JOINT_PARTS_HELD * joint + kind];
}

static struct rb_linkage_free free_of(const struct rb_joint_rows *rows, int which, double t)
{
	struct rb_pose end[2];

	rb_joint_rows_ends(rows, which, t, end);
	return rb_linkage_free(&rows->l->model->joints->joint[which].link, &end[0], &end[1]);
}

/* m/s or rad/s: of what the rate of a free coordinate is the difference of. */
static double rates_of(const struct rb_joint_rows *rows, int which, double t)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[which];
	struct rb_pose end[2];

	rb_joint_rows_ends(rows, which, t, end);
	const double spin = rb_vec3_length(end[0].spin) + rb_vec3_length(end[1].spin);

	if (rb_linkage_turns(&joint->link))
		return spin;
	return rb_vec3_length(end[0].velocity) + rb_vec3_length(end[1].velocity) +
	       spin * joint->size;
}

double rb_joint_drives_noise(const struct rb_joint_rows *rows, int which, double t)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[which];
	const double fall = rb_joint_rows_fall(rows->l, which);

	return DRIVE_ULP * DBL_EPSILON *
	       (rates_of(rows, which, t) +
	        (rb_linkage_turns(&joint->link) ? fall / joint->size : fall));
}

struct rb_joint_off rb_joint_drives_off(const struct rb_joint_rows *rows, int which, double t)
{
	const struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[which];
	const struct rb_linkage_free free = free_of(rows, which, t);
	const struct rb_follow_point to = rb_follow_at(l, which, t, false);
	const double value = rb_joint_state_angle(&l->world->joint[which], &joint->link, t, &free);
	const double size = rb_linkage_turns(&joint->link) ? 1 : joint->size;
	const double lever = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const double reach = fmax(size, fmax(fabs(value), fabs(to.value)));

	return (struct rb_joint_off){.value = value - to.value,
	                             .rate = free.rate - to.rate,
	                             .band = ANGLE_ULP * DBL_EPSILON * (reach + t * fabs(to.rate)),
	                             .noise = rb_joint_drives_noise(rows, which, t) + to.noise,
	                             .lever = lever,
	                             .reach = reach,
	                             .speed = rates_of(rows, which, t) + to.speed_max};
}

/* Of a stop: where it touches and neither parts nor approaches it may hold, as its force says. */
static void begin_stop(const struct rb_joint_rows *rows, int which, int stop, double t, bool anew,
                       double slack)
{
	const struct rb_joint *joint = &rows->l->model->joints->joint[which];
	signed char *const mode = mode_of(rows, which, stop);

	if (!rb_joint_rows_has_stop(joint, stop) || (*mode == RB_DRIVE_HELD && !anew))
		return;
	const struct rb_joint_stop now = rb_joint_rows_stop(rows, which, stop, t);
	const double scale = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const bool touches = *mode == RB_DRIVE_REACHED || now.gap <= now.band;

	/* what has just been found to rise less than it rounds does not part */
	const bool rises = *mode == RB_DRIVE_REACHED && now.rate > 0;

	*mode = touches && (rises || fabs(now.rate) <= now.noise + slack / scale) ? RB_DRIVE_HELD
	                                                                          : RB_STOP_OPEN;
}

/*
 * Has the piece come to its end, at which a drive is at its speed? Something else may have cut it.
 */
static bool has_ended(const struct rb_located *l, int which, double t)
{
	const struct rb_joint *joint = &l->model->joints->joint[which];
	const int body = rb_located_fixed(l, joint->a) ? joint->b : joint->a;

	return !rb_located_on_piece(l, body) || t >= l->piece[body].until_s;
}

/*
 * Has the piece ended as soon as it began? What it has found to exceed its bound at rest does,
 * whatever the solver says: their forces differ by the rounding of loads that cancel.
 */
static bool has_ended_at_once(const struct rb_located *l, int which, double t)
{
	const struct rb_joint *joint = &l->model->joints->joint[which];
	const int body = rb_located_fixed(l, joint->a) ? joint->b : joint->a;
	const double fall = rb_joint_rows_fall(l, which);
	const double natural_s = fall > 0 ? joint->size / fall : 0;

	return rb_located_on_piece(l, body) &&
	       t - l->piece[body].origin_s <= AT_ONCE_ULP * DBL_EPSILON * fmax(t, natural_s);
}

/*
 * Modes that are to change at the end of a piece do, if it is that which has ended. `sure`: of each
 * drive, whether it is known to be at its bound.
 */
static void take_next(const struct rb_joint_rows *rows, int which, double t,
                      bool sure[RB_JOINT_PARTS_HELD])
{
	struct rb_located *l = rows->l;

	for (int part = 0; part < RB_JOINT_PARTS_HELD; part++) {
		signed char *const next = &l->drive_next[RB_JOINT_PARTS_HELD * which + part];
		const bool changes = *next != RB_DRIVE_KEEPS && has_ended(l, which, t);

		sure[part] = changes && *mode_of(rows, which, part) == RB_DRIVE_HELD &&
		             has_ended_at_once(l, which, t);
		/* what is to go on as it was (keep_on), had no time to */
		if (part == RB_DRIVE_MOTOR && *next == *mode_of(rows, which, part) &&
		    has_ended_at_once(l, which, t))
			continue;
		if (changes)
			*mode_of(rows, which, part) = *next;
		*next = RB_DRIVE_KEEPS;
	}
}

/* Of what keeps a speed. */
static void begin_drive(const struct rb_joint_rows *rows, int which, int kind, double t, bool anew)
{
	signed char *const mode = mode_of(rows, which, kind);
	const double v = free_of(rows, which, t).rate -
	                 rb_joint_rows_drive_now(rows->l, which, kind).speed;

	if ((!anew && (*mode == RB_DRIVE_HELD || *mode == RB_DRIVE_REACHED)) ||
	    fabs(v) <= rb_joint_drives_noise(rows, which, t))
		*mode = RB_DRIVE_HELD;
	else
		*mode = v < 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
}

bool rb_joint_drives_stopped(const struct rb_located *l, int which)
{
	const signed char *const mode = &l->drive_mode[RB_JOINT_PARTS_HELD * which];
	bool any = false;

	for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++)
		any = any || (mode[stop] == RB_DRIVE_HELD &&
		              rb_joint_rows_has_stop(&l->model->joints->joint[which], stop));
	return any;
}

/*
 * What cannot go back with all that acts now does not try to at once again: the piece to come has
 * its mode whatever brakes.
 */
static void keep_on(const struct rb_joint_rows *rows, int which)
{
	rows->l->drive_next[RB_JOINT_PARTS_HELD * which + RB_DRIVE_MOTOR] = *mode_of(
		rows, which, RB_DRIVE_MOTOR);
}

/*
 * Of a motor that follows. Held, it stays so, whatever it has drifted in the piece, but for jumps:
 * of what it follows, or by an impact. At a bound it goes on as long as it pushes towards what it
 * follows, or brakes.
 */
static void begin_follow(const struct rb_joint_rows *rows, int which, double t, bool anew,
                         double slack)
{
	struct rb_located *l = rows->l;
	signed char *const mode = mode_of(rows, which, RB_DRIVE_MOTOR);
	const bool kept = *mode == RB_DRIVE_HELD, jumps = rb_follow_begin(l, which, t);

	if (l->status != RB_OK || (kept && !jumps && !anew))
		return;
	const struct rb_joint_off off = rb_joint_drives_off(rows, which, t);
	const struct rb_follow_point on = rb_follow_at(l, which, t, true);
	const struct rb_follow_point to = rb_follow_at(l, which, t, false);
	/* on the way back it is as far off as that says */
	const double e = off.value - (kept ? on.value - to.value : 0);
	const double v = off.rate - (kept ? on.rate - to.rate : 0);
	const double share = kept ? rb_joint_drift_max : 0;
	const double noise = off.noise + (anew ? slack / off.lever : 0);

	if (fabs(e) <= fmax(off.band, share * off.reach) &&
	    fabs(v) <= fmax(noise, jumps ? share * off.speed : 0)) {
		*mode = RB_DRIVE_HELD;
		return;
	}
	rb_follow_end_return(l, which);
	if (*mode == RB_DRIVE_REACHED && !anew && !rb_joint_drives_stopped(l, which) &&
	    rb_follow_converges(off.value, off.rate)) {
		rb_follow_begin_return(l, which, t, off.value, off.rate);
		*mode = RB_DRIVE_HELD;
	} else if ((*mode != RB_DRIVE_LOW && *mode != RB_DRIVE_HIGH) || anew ||
	           rb_joint_off_ends(&off, *mode)) {
		const double towards = fabs(off.value) > off.band ? off.value : off.rate;
		const bool refused = *mode == RB_DRIVE_REACHED && !anew;

		*mode = towards < 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
		if (refused)
			keep_on(rows, which);
	}
}

static void follow(const struct rb_joint_rows *rows, int which, double t, bool anew, double slack)
{
	begin_follow(rows, which, t, anew, slack);
	if (*mode_of(rows, which, RB_DRIVE_MOTOR) == RB_DRIVE_HELD)
		rows->l->drive_next[RB_JOINT_PARTS_HELD * which + RB_DRIVE_MOTOR] = RB_DRIVE_KEEPS;
}

void rb_joint_drives_begin(const struct rb_joint_rows *rows, double t, bool anew, double slack)
{
	for (int k = 0; k < rows->joint_count; k++) {
		const int which = rows->joint[k];
		bool sure[RB_JOINT_PARTS_HELD];

		take_next(rows, which, t, sure);
		for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++)
			begin_stop(rows, which, stop, t, anew, slack);
		for (int kind = 0;
		     kind < RB_JOINT_DRIVES && rb_joint_rows_has_drive(rows->l, which); kind++) {
			if (kind == RB_DRIVE_MOTOR && rb_follow_has(rows->l, which))
				follow(rows, which, t, anew, slack);
			else if (anew || !sure[kind])
				begin_drive(rows, which, kind, t, anew);
		}
	}
}

/* Whether velocities were set, by the scene or a callback, where drives or stops may hold. */
static bool may_not_fit(const struct rb_joint_rows *rows)
{
	const struct rb_located *l = rows->l;
	bool set = l->starting, holds = false;

	for (int k = 0; k < rows->joint_count; k++) {
		const int which = rows->joint[k];
		const struct rb_joint *joint = &l->model->joints->joint[which];

		set = set || l->world->joint[which].was_set;
		holds = holds || rb_joint_rows_has_drive(l, which) ||
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
			const int which = rows->joint[k];
			const signed char was = *mode_of(rows, which, kind);

			if (!rb_joint_rows_has_drive(rows->l, which) ||
			    (kind == RB_DRIVE_MOTOR && rb_follow_has(rows->l, which)) ||
			    (was != RB_DRIVE_LOW && was != RB_DRIVE_HIGH))
				continue;
			begin_drive(rows, which, kind, t, true);
			any = any || *mode_of(rows, which, kind) != was;
		}
	if (any)
		rb_joint_rows_fill(rows, t);
}

double rb_joint_drives_soon(const struct rb_located *l, int which, int kind, double *impulse)
{
	const struct rb_joint *joint = &l->model->joints->joint[which];
	const double lever = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const double force = rb_joint_rows_drive_now(l, which, kind).max / lever;
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
			const int which = rows->joint[k];
			const struct rb_joint_drive drive = rb_joint_rows_drive_now(rows->l, which,
			                                                            kind);
			signed char *const mode = mode_of(rows, which, kind);

			if (!(drive.max > 0) || isnan(drive.speed) || *mode == RB_DRIVE_HELD ||
			    !(fabs(free_of(rows, which, t).rate - drive.speed) <=
			      rb_joint_drives_soon(rows->l, which, kind, NULL)))
				continue;
			*mode = RB_DRIVE_HELD;
			any = true;
		}
	return any;
}

/* Multiplier of that part's row; 0: it has none. */
static double multiplier_of(const struct rb_joint_rows *rows, const double *multiplier, int which,
                            int part)
{
	for (int k = 0; k < rows->count; k++)
		if (rows->row[k].joint == which && rows->row[k].drive == part)
			return multiplier[k];
	return 0;
}

/*
 * A stop and a motor that follows cannot both hold what the motor moves: their rows are the same,
 * with different right sides. Where it moves off the stop, with what both exert within its bound,
 * the stop is open; else the motor is at its bound, towards where it moves.
 */
static void part_from_stop(const struct rb_joint_rows *rows, const double *multiplier, int which,
                           int stop, double t)
{
	struct rb_located *l = rows->l;
	const struct rb_joint *joint = &l->model->joints->joint[which];
	signed char *const motor = mode_of(rows, which, RB_DRIVE_MOTOR);

	if (!rb_joint_rows_has_stop(joint, stop) || *mode_of(rows, which, stop) != RB_DRIVE_HELD ||
	    *motor != RB_DRIVE_HELD || !rb_follow_has(l, which) || !rb_follow_moves(l, which))
		return;
	const struct rb_follow_point to = rb_follow_at(l, which, t, true);
	const double sign = stop == RB_STOP_LOW ? 1 : -1;
	const double moves = fabs(to.rate) > to.noise ? to.rate : to.acceleration;
	const double scale = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const double bound = rb_joint_rows_drive_now(l, which, RB_DRIVE_MOTOR).max / scale;
	const double both = sign * multiplier_of(rows, multiplier, which, RB_DRIVE_MOTOR) +
	                    multiplier_of(rows, multiplier, which, stop);

	if (sign * moves > 0 && both <= bound) {
		*mode_of(rows, which, stop) = RB_STOP_OPEN;
		return;
	}
	*motor = moves > 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
	rb_follow_end_return(l, which);
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
			part_from_stop(rows, multiplier, rows->joint[k], stop, t);
}
