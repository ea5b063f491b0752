/* SPDX-License-Identifier: MIT */
/*
 * Ends of contact modes within a piece: sticking that needs more than its friction, slip that
 * stops, a contact that pulls, a point that leaves its features. Laws are tested at samples of the
 * piece, and the first violation is bisected on the dense output.
 */
#include "located/mode_checks.h"

#include "base/error.h"

#include <float.h>

#include "located/follow.h"
#include "located/joint_drives.h"
#include "located/other_forces.h"
#include "located/rates.h"
#include "located/event_set.h"

/*
 * Violation of a law relative to the forces at which it counts, such that the next mode does not
 * find it satisfied again.
 */
static const double violation = 1e-11;
/* A piece cut within 1/1024 of its length was cut at its beginning. */
enum { AT_ONCE = 1024 };
enum { SAMPLES = 8, GAP_SAMPLES = 16, BISECTIONS = 80, HIT_ULP = 8 };
/* Rounding of time in ulp: shorter pieces have no length. */
enum { RISE_ULP = 2 };

double rb_check_excess(const struct rb_modes *w, int k)
{
	const rb_vec3 n = w->contact_point[k].normal;
	const double normal_force = rb_vec3_dot(w->force[k], n);

	RB_ASSERT_COSTLY(k >= 0);
	if (w->c->held[k].slipping)
		return -normal_force;
	return fmax(-normal_force, rb_vec3_length(rb_vec3_reject(w->force[k], n)) -
	                                   w->contact[k].friction * normal_force);
}

/* True if contact k satisfies its mode's law within the uncertainty of the forces. */
static bool is_lawful(const struct rb_modes *w, int k)
{
	const struct rb_held *held = &w->c->held[k];
	const double *const inverse = w->l->model->inverse_mass;
	const double weight = w->max / (inverse[held->a] + inverse[held->b]);

	return rb_check_excess(w, k) <=
	       fmax(violation * fmax(w->force_max, weight), w->uncertainty);
}

/* True if the pair approaches at a point that is not among its held ones [first, end). */
static bool approaches_elsewhere(const struct rb_modes *w, int first, int end)
{
	const struct rb_held *held = &w->c->held[first];
	const struct rb_touch_pair pair = {held->a, held->b, w->origin_s,
	                                   w->contact_point[first].pose_a,
	                                   w->contact_point[first].pose_b};
	struct rb_contact_point all[RB_CONTACT_POINTS_MAX];
	const int count = rb_touch_all(w->l, &pair, 0, all);

	for (int k = 0; k < count; k++) {
		bool known = rb_vec3_dot(all[k].velocity, all[k].normal) >=
		                     -rb_contact_point_noise(w->l, &all[k]) ||
		             rb_contact_point_passes(w->l, &all[k], w->origin_s);
		for (int i = first; i < end && !known; i++)
			known = rb_event_set_is_same_place(w->l, &all[k], &w->contact_point[i]);
		if (!known)
			return true;
	}
	return false;
}

/* Gap of the lowest held point of the pair whose first one is k, m; *end: after its last one. */
static double lowest_held(const struct rb_modes *w, int k, int *end)
{
	const struct rb_held *held = &w->c->held[k];
	double low = w->contact_point[k].gap;

	for (*end = k + 1; *end < w->c->held_count; ++*end) {
		if (w->c->held[*end].a != held->a || w->c->held[*end].b != held->b)
			break;
		low = fmin(low, w->contact_point[*end].gap);
	}
	return low;
}

/* Depth of the named point below the pair's held ones, the first of which is k, at time s, m. */
static double depth_at(struct rb_modes *w, int k, const struct rb_contact_name *name, double s,
                       double *value)
{
	const struct rb_contact_point *m = &w->contact_point[k];
	int end;

	rb_gauss_values(&w->c->piece, s, value);
	if (rb_rates_are_stopped(w) || !rb_rates_evaluate(w, w->origin_s + s, value))
		return 0;
	return lowest_held(w, k, &end) -
	       rb_contact_point_of(w->l, name, &m->pose_a, &m->pose_b).gap;
}

/*
 * Time at which the point found below the held ones at `s` reached their level (false position,
 * with the older end halved: Dowell, Jarratt, BIT 11 (1971) 168). At `s` it is deeper than
 * rounding; correcting it there would lift the body at each impact, so that rocking would never
 * end.
 */
static double touch_time(struct rb_modes *w, int k, double s, double *value)
{
	rb_gauss_values(&w->c->piece, s, value);
	if (!rb_rates_evaluate(w, w->origin_s + s, value))
		return s;
	const struct rb_contact_point *m = &w->contact_point[k];
	const struct rb_contact_point now = rb_contact_point_poses(w->l, m->a, m->b, &m->pose_a,
	                                                           &m->pose_b);
	const struct rb_contact_name name = rb_contact_name_of(&now);
	const double rate = -rb_vec3_dot(now.velocity, now.normal);
	double below_s = s, below = depth_at(w, k, &name, s, value);
	/* at least an ulp back, from which the search doubles its way */
	double above_s = fmin(s - 2 * below / rate, nextafter(s, 0)), above;

	if (!(below > 0) || !(rate > 0))
		return s;
	for (;; above_s -= s - above_s) {
		above_s = fmax(above_s, 0);
		above = depth_at(w, k, &name, above_s, value);
		if (above <= 0)
			break;
		if (!(above_s > 0)) /* it was never above */
			return s;
	}
	for (int round = 0, side = 0; round < BISECTIONS; round++) {
		const double next = below_s - below * ((below_s - above_s) / (below - above));

		if (!(next > above_s && next < below_s))
			break;
		const double depth = depth_at(w, k, &name, next, value);
		if (depth > 0) {
			below_s = next;
			below = depth;
			above *= side > 0 ? 0.5 : 1;
			side = 1;
		} else {
			above_s = next;
			above = depth;
			below *= side < 0 ? 0.5 : 1;
			side = -1;
		}
		if (depth == 0)
			return next;
	}
	return below_s;
}

/*
 * True if the pair of the held points [k, end) approached elsewhere when the point that is lowest
 * at `s` reached their level in this piece: a point that moves sideways as it falls has left its
 * features once it is deep. Restores the state at `s`.
 */
static bool has_approached(struct rb_modes *w, int k, int end,
                           const struct rb_contact_point *lowest, double s, double *value)
{
	const struct rb_contact_name name = rb_contact_name_of(lowest);
	bool hit = false;

	if (!(rb_vec3_dot(lowest->velocity, lowest->normal) < 0))
		return false;
	if (!(depth_at(w, k, &name, 0, value) > 0)) {
		const double touch_s = touch_time(w, k, s, value);

		rb_gauss_values(&w->c->piece, touch_s, value);
		hit = rb_rates_evaluate(w, w->origin_s + touch_s, value) &&
		      approaches_elsewhere(w, k, end);
	}
	rb_gauss_values(&w->c->piece, s, value);
	return rb_rates_evaluate(w, w->origin_s + s, value) && hit;
}

/*
 * True if another point of the pair, not held, lies below the held ones: the bodies collide there.
 * Checked once per pair; held points may have drifted by integration.
 */
static bool collides_elsewhere(struct rb_modes *w, int k, double s, double *value)
{
	const struct rb_contact_point *m = &w->contact_point[k];
	const struct rb_held *held = &w->c->held[k];
	int end;

	if (rb_event_set_is_single(w->l, held->a, held->b) ||
	    (k > 0 && held[-1].a == held->a && held[-1].b == held->b))
		return false;
	const double low = lowest_held(w, k, &end);
	if (rb_modes_move(w))
		w->l->products += RB_LOCATED_SEARCH;
	const struct rb_contact_point now = rb_contact_point_poses(w->l, held->a, held->b,
	                                                           &m->pose_a, &m->pose_b);

	/* gaps in a piece round by the sizes, wherever the bodies are */
	return now.gap < low - HIT_ULP * DBL_EPSILON * rb_contact_point_largest(w->l, &now) &&
	       (approaches_elsewhere(w, k, end) || has_approached(w, k, end, &now, s, value));
}

/* The first contact that violates its mode in this state; -1: none. */
static int broken(struct rb_modes *w, double s, double *value)
{
	const double t = w->origin_s + s;
	const struct rb_cluster *c = w->c;
	bool inspected = false;

	for (int k = 0; k < c->held_count; k++) {
		const struct rb_held *held = &c->held[k];
		const struct rb_contact_point *m = &w->contact_point[k];

		w->slip_ends = false;
		w->hits = collides_elsewhere(w, k, s, value);
		if (held->creeps &&
		    rb_vec3_dot(m->velocity, w->contact[k].slip) > 2 * rb_event_set_creep(w->l, m))
			return k;
		if (m->on_rim != held->on_rim || rb_event_set_has_left(w->l, m) || w->hits)
			return k;
		if (!inspected && !is_lawful(w, k)) {
			if (!w->dense.open || !rb_other_forces_hold(w, t))
				return k;
			inspected = true;
		}
		/* without friction, reversal of the slip changes nothing */
		w->slip_ends = held->slipping && held->friction > 0 &&
		               (held->straight || held->creeps) &&
		               rb_vec3_dot(m->velocity, w->contact[k].slip) < 0;
		if (w->slip_ends)
			return k;
	}
	return -1;
}

/* `broken` at s seconds into the piece. */
static int broken_at(struct rb_modes *w, double s, double *value)
{
	if (rb_rates_are_stopped(w))
		return -1;
	rb_gauss_values(&w->c->piece, s, value);
	return rb_rates_evaluate(w, w->origin_s + s, value) ? broken(w, s, value) : -1;
}

/* Points of a body stop slipping together: marks all whose slip is zero at s. */
static void end_slips(struct rb_modes *w, double s, double *value)
{
	rb_gauss_values(&w->c->piece, s, value);
	if (!rb_rates_evaluate(w, w->origin_s + s, value))
		return;
	for (int k = 0; k < w->c->held_count; k++) {
		struct rb_held *const held = &w->c->held[k];
		const struct rb_contact_point *m = &w->contact_point[k];

		if (held->slipping && (held->straight || held->creeps) &&
		    !rb_event_set_is_single(w->l, held->a, held->b))
			held->ending = rb_vec3_dot(m->velocity, w->contact[k].slip) <=
			               rb_contact_point_noise(w->l, m);
	}
}

/*
 * True if a sticking contact needs more than its friction from the beginning of the piece. If
 * forces are open, every moment may have an admissible distribution, but none that lasts; with
 * friction of thousands, the solver's normal residual is large tangentially. Then it slips.
 */
static bool stick_ends(struct rb_modes *w, double s, int contact, double *value)
{
	struct rb_held *const held = &w->c->held[contact];
	const rb_vec3 n = w->contact_point[contact].normal;

	if (held->slipping || w->hits || s > w->c->piece.length_s / AT_ONCE)
		return false;
	rb_gauss_values(&w->c->piece, s, value);
	if (!rb_rates_evaluate(w, w->origin_s + s, value))
		return false;
	const double normal_force = rb_vec3_dot(w->force[contact], n);

	if (!(normal_force > 0) || !(rb_vec3_length(rb_vec3_reject(w->force[contact], n)) >
	                             w->contact[contact].friction * normal_force))
		return false;
	held->force = w->force[contact];
	return true;
}

double rb_check_change_within(struct rb_modes *w, double *value)
{
	const double length = w->c->piece.length_s;
	double good = 0, bad = length;
	int contact = -1;

	w->c->hits = false;
	for (int k = 1; k <= SAMPLES && contact < 0; k++) {
		bad = k < SAMPLES ? length * k / SAMPLES : length;
		contact = broken_at(w, bad, value);
		if (contact < 0)
			good = bad;
	}
	if (contact < 0 || w->l->status != RB_OK)
		return length;
	bool ends = w->slip_ends, hits = w->hits;
	for (int round = 0; round < BISECTIONS && bad - good > 0; round++) {
		const double middle = good + 0.5 * (bad - good);

		if (middle <= good || middle >= bad)
			break;
		const int now = broken_at(w, middle, value);
		if (now >= 0) {
			bad = middle;
			contact = now;
			ends = w->slip_ends;
			hits = w->hits;
		} else {
			good = middle;
		}
	}
	if (hits)
		bad = touch_time(w, contact, bad, value);
	if (ends)
		end_slips(w, bad, value);
	w->c->held[contact].ending = ends || stick_ends(w, bad, contact, value);
	w->c->hits = hits;
	w->c->hit_a = w->c->held[contact].a;
	w->c->hit_b = w->c->held[contact].b;
	return bad;
}

bool rb_check_turns_aside(struct rb_modes *w, double s, double *value)
{
	bool any = false;

	for (int k = 0; k < w->c->held_count; k++)
		any = any || w->c->held[k].straight;
	if (!any)
		return false;
	rb_gauss_values(&w->c->piece, s, value);
	if (!rb_rates_evaluate(w, w->origin_s + s, value))
		return false;
	any = false;
	for (int k = 0; k < w->c->held_count; k++) {
		if (!rb_modes_turns_aside(w, k))
			continue;
		w->c->held[k].straight = false;
		any = true;
	}
	return any;
}

bool rb_check_begins_straight(struct rb_modes *w)
{
	bool any = false;

	RB_ASSERT(w->c->piece.start != NULL);
	if (!rb_rates_evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	for (int k = 0; k < w->c->held_count; k++) {
		struct rb_held *const held = &w->c->held[k];
		const struct rb_contact_point *m = &w->contact_point[k];
		const double speed = rb_vec3_length(rb_vec3_reject(m->velocity, m->normal));

		if (!held->slipping || held->straight || held->creeps ||
		    speed > 4 * rb_contact_point_noise(w->l, m))
			continue;
		held->straight = any = true;
	}
	return any;
}

bool rb_check_creeping_breaks_laws(struct rb_modes *w)
{
	double max = 0, excess = 0;
	bool creeps = false;

	RB_ASSERT(w->balanced);
	for (int k = 0; k < w->c->held_count; k++) {
		const struct rb_contact_point *m = &w->contact_point[k];

		/* it would end at once */
		if (w->c->held[k].creeps &&
		    rb_vec3_dot(m->velocity, w->contact[k].slip) < -rb_contact_point_noise(w->l, m))
			return true;
		creeps = creeps || w->c->held[k].creeps;
		max = fmax(max, rb_vec3_length(w->force[k]));
		excess = fmax(excess, rb_check_excess(w, k));
	}
	if (!creeps || !(excess > RB_CHECK_DOUBTFUL * max))
		return false;
	return !w->dense.open || !rb_other_forces_hold(w, w->origin_s) ||
	       !rb_rates_evaluate(w, w->origin_s, w->c->piece.start);
}

/* ---- limits and ropes of joints ---- */

/* An open stop, with its state at the previous sample. */
struct open_stop {
	int joint, stop;
	double gap, rate;
};

static struct rb_joint_stop stop_now(const struct rb_modes *w, const struct open_stop *open,
                                     double s)
{
	return rb_joint_rows_stop(&w->joints, open->joint, open->stop, w->origin_s + s);
}

static struct rb_joint_stop stop_at(struct rb_modes *w, const struct open_stop *open, double s,
                                    double *value)
{
	rb_gauss_values(&w->c->piece, s, value);
	rb_rates_poses(w, value);
	return stop_now(w, open, s);
}

/* Time of the zero of a rate that is negative before and positive after it, s. */
static double turning_point(struct rb_modes *w, const struct open_stop *open, double low,
                            double high, double *value)
{
	for (int round = 0; round < BISECTIONS; round++) {
		const double middle = low + 0.5 * (high - low);

		if (middle <= low || middle >= high)
			break;
		if (stop_at(w, open, middle, value).rate < 0)
			low = middle;
		else
			high = middle;
	}
	return high;
}

/* Time at which the gap closes, s: the first at which it is negative. */
static double closing_time(struct rb_modes *w, const struct open_stop *open, double good,
                           double bad, double *value)
{
	for (int round = 0; round < BISECTIONS; round++) {
		const double middle = good + 0.5 * (bad - good);

		if (middle <= good || middle >= bad)
			break;
		if (stop_at(w, open, middle, value).gap < 0)
			bad = middle;
		else
			good = middle;
	}
	return bad;
}

/*
 * Can the gap close between two samples: is it closed at the second one, or negative at the
 * intersection of the tangents?
 */
static bool may_close(const struct open_stop *before, const struct rb_joint_stop *now, double time)
{
	const double low = before->rate, high = now->rate;

	if (now->gap < -now->band)
		return true;
	if (!(low < 0) || !(high > 0))
		return false;
	return before->gap + low * (now->gap - before->gap - high * time) / (low - high) < 0;
}

/* Time at which it closes within (from, to], s; INFINITY: it does not, beyond rounding. */
static double closed_within(struct rb_modes *w, const struct open_stop *before,
                            const struct rb_joint_stop *now, double from, double to, double *value)
{
	if (now->gap < -now->band)
		return closing_time(w, before, from, to, value);
	const double lowest_s = turning_point(w, before, from, to, value);
	const struct rb_joint_stop lowest = stop_at(w, before, lowest_s, value);

	return lowest.gap < -lowest.band ? closing_time(w, before, from, lowest_s, value)
	                                 : (double)INFINITY;
}

/* Returns the open stops; NULL and l->status: out of memory. */
static struct open_stop *open_stops(const struct rb_modes *w, int *count)
{
	struct rb_located *l = w->l;
	struct open_stop *const open = rb_arena_take(
		l->arena, 2 * (size_t)w->joints.joint_count + 1, sizeof *open);

	*count = 0;
	if (!open)
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for joints");
	for (int k = 0; open && k < w->joints.joint_count; k++)
		for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++) {
			const int joint = w->joints.joint[k];

			if (rb_joint_rows_has_stop(&l->model->joints->joint[joint], stop) &&
			    l->drive_mode[RB_JOINT_PARTS_HELD * joint + stop] != RB_DRIVE_HELD)
				open[(*count)++] = (struct open_stop){.joint = joint, .stop = stop};
		}
	return open;
}

/*
 * A stop that touches, separates, and closes again from the beginning of the piece rises by less
 * than the rounding of gaps: it may hold from then on, otherwise it would touch again forever.
 */
static void end_rise(struct rb_modes *w, const struct open_stop *stop, double s, double *value)
{
	const struct rb_joint_stop now = stop_at(w, stop, s, value);

	if (now.gap < 0 && now.gap >= -now.band && now.rate > 0)
		w->l->drive_next[RB_JOINT_PARTS_HELD * stop->joint + stop->stop] = RB_DRIVE_REACHED;
}

double rb_check_stops_within(struct rb_modes *w, double length, double *value)
{
	const rb_arena_mark here = rb_arena_here(w->l->arena);
	int count;
	struct open_stop *const open = open_stops(w, &count);
	double end = (double)INFINITY;

	for (int k = 0; k <= GAP_SAMPLES && count > 0 && isinf(end); k++) {
		const double before = length * (k - 1) / GAP_SAMPLES;
		const double s = k < GAP_SAMPLES ? length * k / GAP_SAMPLES : length;

		rb_gauss_values(&w->c->piece, s, value);
		rb_rates_poses(w, value);
		for (int i = 0; i < count; i++) {
			const struct rb_joint_stop now = stop_now(w, &open[i], s);
			const bool near = k > 0 && may_close(&open[i], &now, s - before);

			if (near)
				end = fmin(end, closed_within(w, &open[i], &now, before, s, value));
			if (near) {
				rb_gauss_values(&w->c->piece, s, value);
				rb_rates_poses(w, value);
			}
			open[i].gap = now.gap;
			open[i].rate = now.rate;
		}
	}
	if (end <= RISE_ULP * DBL_EPSILON * w->origin_s)
		for (int i = 0; i < count; i++)
			end_rise(w, &open[i], end, value);
	rb_arena_back(w->l->arena, here);
	return fmin(end, length);
}

/* ---- drives and stops of joints ---- */

/* Force to which the rounding of a stop's forces is relative, N. */
static double force_scale(const struct rb_modes *w, const struct rb_joint_row *row)
{
	const double *const inverse = w->l->model->inverse_mass;
	const double a = row->a >= 0 ? inverse[w->c->member[row->a]] : 0;
	const double b = row->b >= 0 ? inverse[w->c->member[row->b]] : 0;
	double max = w->max / (a + b);

	for (int k = 0; k < w->joints.count; k++)
		max = fmax(max, fabs(w->multiplier[k]));
	return max;
}

/* Acceleration of the free coordinate relative to the followed motion, rad/s^2 or m/s^2. */
static double relative_acceleration(const struct rb_modes *w, int k)
{
	struct rb_joint_spring_row spring;

	if (!rb_joint_rows_spring(&w->joints, k, w->time_s, &spring))
		return 0;
	const struct rb_coupled_row row = rb_joint_rows_coupled(&spring.row);

	return rb_coupled_rate(&row, w->linear, w->angular) + spring.row.bias -
	       rb_follow_at(w->l, spring.row.joint, w->time_s, false).acceleration;
}

/*
 * For the motor of the k-th joint, which returns to the motion that it follows at its bound: must
 * it begin to brake now? That is, does braking need its share of the force beyond the one that
 * keeps the rate constant? Forces are linear in accelerations: that one follows from the bound and
 * the braking force. Leaves forces as if it braked.
 */
static bool must_brake(struct rb_modes *w, int k, const struct rb_joint_off *off,
                       const double *value)
{
	struct rb_located *l = w->l;
	const int joint = w->joints.joint[k];
	signed char *const mode = &l->drive_mode[RB_JOINT_PARTS_HELD * joint + RB_DRIVE_MOTOR];
	const signed char now = *mode;
	/* another check may have left other forces */
	const bool known = rb_rates_evaluate(w, w->time_s, value);
	const double pushed = now * relative_acceleration(w, k);
	const double braked = now * off->rate * off->rate / (2 * off->value);
	double needed = -1; /* braking force relative to the bound; -1: the bound accelerates it */

	*mode = RB_DRIVE_HELD;
	rb_follow_begin_return(l, joint, w->time_s, off->value, off->rate);
	const bool good = known && rb_rates_evaluate(w, w->time_s, value);
	for (int r = 0; r < w->joints.count && good; r++) {
		const struct rb_joint_row *row = &w->joints.row[r];

		if (row->joint == joint && row->drive == RB_DRIVE_MOTOR)
			needed = -now * w->multiplier[r] / rb_joint_rows_bound(&w->joints, row);
	}
	*mode = now;
	rb_follow_end_return(l, joint);
	const double kept = needed + (needed + 1) * braked / (pushed - braked);

	return needed >= kept + rb_follow_brake * (1 - kept);
}

/*
 * Next mode of a motor that follows, at a bound; RB_DRIVE_KEEPS: none. A stop that holds leaves
 * nothing to brake: the followed motion leads away from it.
 */
static signed char follow_then(struct rb_modes *w, int k, const double *value)
{
	const int joint = w->joints.joint[k];
	const int mode = w->l->drive_mode[RB_JOINT_PARTS_HELD * joint + RB_DRIVE_MOTOR];

	if (mode != RB_DRIVE_LOW && mode != RB_DRIVE_HIGH)
		return RB_DRIVE_KEEPS;
	const struct rb_joint_off off = rb_joint_drives_off(&w->joints, joint, w->time_s);

	if (rb_joint_off_ends(&off, mode))
		return mode == RB_DRIVE_LOW ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
	if (!w->goes_on && w->l->drive_next[RB_JOINT_PARTS_HELD * joint + RB_DRIVE_MOTOR] == mode)
		return RB_DRIVE_KEEPS;
	return !rb_joint_drives_stopped(w->l, joint) && mode * off.value < -off.band &&
	                       mode * off.rate > off.noise && must_brake(w, k, &off, value)
	               ? RB_DRIVE_REACHED
	               : RB_DRIVE_KEEPS;
}

/* Has a drive, off by `v`, reached its speed? Where loads balance it, its rate is rounding. */
static bool has_reached(const struct rb_modes *w, const struct rb_joint_spring_row *spring,
                        int mode, double v)
{
	const int joint_index = spring->row.joint;
	const struct rb_joint *joint = &w->l->model->joints->joint[joint_index];
	const double lever = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const struct rb_coupled_row row = rb_joint_rows_coupled(&spring->row);
	const double acceleration = rb_coupled_rate(&row, w->linear, w->angular) + spring->row.bias;

	return (mode == RB_DRIVE_LOW || mode == RB_DRIVE_HIGH) && mode * v > 0 &&
	       (mode * acceleration * lever > violation * w->max ||
	        mode * v > rb_joint_drives_noise(&w->joints, joint_index, w->time_s));
}

/*
 * Returns the first drive or stop whose mode ends in this state, as the address of its next mode,
 * and in `then` that mode; NULL: all hold.
 */
static signed char *broken_drive(struct rb_modes *w, const double *value, signed char *then)
{
	const struct rb_located *l = w->l;

	for (int k = 0; k < w->joints.count; k++) {
		const struct rb_joint_row *row = &w->joints.row[k];
		const bool stop = rb_joint_rows_is_stop(row);
		const bool holds = row->drive < 0 ||
		                   (stop ? w->multiplier[k] >= -violation * force_scale(w, row)
		                         : fabs(w->multiplier[k]) <=
		                                    rb_joint_rows_bound(&w->joints, row) *
		                                            (1 + violation));

		if (holds)
			continue;
		*then = stop ? RB_STOP_OPEN : w->multiplier[k] > 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
		/* if forces are open, others than the smallest may be admissible */
		if (w->dense.open && rb_other_forces_hold(w, w->time_s))
			break;
		return &l->drive_next[RB_JOINT_PARTS_HELD * row->joint + row->drive];
	}
	for (int k = 0; k < w->joints.joint_count; k++) {
		const int joint = w->joints.joint[k];
		struct rb_joint_spring_row spring;

		if (rb_joint_drives_stopped(l, joint) ||
		    !rb_joint_rows_spring(&w->joints, k, w->time_s, &spring))
			continue;
		for (int kind = 0; kind < RB_JOINT_DRIVES; kind++) {
			const struct rb_joint_drive drive = rb_joint_rows_drive_now(l, joint, kind);
			const int part = RB_JOINT_PARTS_HELD * joint + kind;
			const double v = spring.row.velocity - drive.speed;

			if (!(drive.max > 0) || isnan(v))
				continue;
			*then = RB_DRIVE_REACHED;
			if (has_reached(w, &spring, l->drive_mode[part], v))
				return &l->drive_next[part];
		}
	}
	/* last, because must_brake leaves other forces */
	for (int k = 0; k < w->joints.joint_count; k++) {
		const int joint = w->joints.joint[k];

		if (!rb_follow_has(l, joint) ||
		    !(rb_joint_rows_drive_now(l, joint, RB_DRIVE_MOTOR).max > 0))
			continue;
		*then = follow_then(w, k, value);
		if (*then != RB_DRIVE_KEEPS)
			return &l->drive_next[RB_JOINT_PARTS_HELD * joint + RB_DRIVE_MOTOR];
	}
	return NULL;
}

static signed char *broken_drive_at(struct rb_modes *w, double s, double *value, signed char *then)
{
	rb_gauss_values(&w->c->piece, s, value);
	return rb_rates_evaluate(w, w->origin_s + s, value) ? broken_drive(w, value, then) : NULL;
}

/* Is there a drive, or a stop that holds? */
static bool has_held(const struct rb_modes *w)
{
	bool any = rb_joint_rows_drive(&w->joints);

	for (int k = 0; k < w->joints.joint_count && !any; k++)
		for (int kind = 0; kind < RB_JOINT_DRIVES; kind++)
			any = any ||
			      rb_joint_rows_drive_now(w->l, w->joints.joint[k], kind).max > 0;
	return any;
}

double rb_check_drives_within(struct rb_modes *w, double length, double *value)
{
	double good = 0, bad = length;
	signed char *next_mode = NULL, then = 0, at_once = 0;

	if (!has_held(w))
		return length;
	for (int k = 1; k <= SAMPLES && !next_mode; k++) {
		bad = k < SAMPLES ? length * k / SAMPLES : length;
		next_mode = broken_drive_at(w, bad, value, &then);
		if (!next_mode)
			good = bad;
	}
	if (!next_mode || w->l->status != RB_OK)
		return length;
	/* at once, where stops open and hold again in turn */
	const double least = fmin(nextafter(w->origin_s, HUGE_VAL) - w->origin_s, bad);
	signed char *const first = good > 0 ? NULL : broken_drive_at(w, least, value, &at_once);
	if (first) {
		*first = at_once;
		return least;
	}
	for (int round = 0; round < BISECTIONS && bad - good > 0; round++) {
		const double middle = good + 0.5 * (bad - good);
		signed char mode;

		if (middle <= good || middle >= bad)
			break;
		signed char *const now = broken_drive_at(w, middle, value, &mode);
		if (now) {
			bad = middle;
			next_mode = now;
			then = mode;
		} else {
			good = middle;
		}
	}
	*next_mode = then;
	return bad;
}
