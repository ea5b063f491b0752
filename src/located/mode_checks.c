/* SPDX-License-Identifier: MIT */
/*
 * Ends of contact modes within a piece: stick that needs more than its friction, slip that stops, a
 * contact that pulls, a point that leaves its features. Laws are tested at samples of the piece and
 * the first failure is bisected on the dense output.
 */
#include "located/mode_checks.h"

#include "base/error.h"

#include <float.h>
#include <string.h>

#include "located/follow.h"
#include "located/joint_drives.h"
#include "located/rates.h"
#include "located/event_set.h"

/*
 * Share of the forces by which a law must be violated to count, so that the next mode does not see
 * it hold again.
 */
static const double clear = 1e-11;
/* A piece cut within 1/1024 of its length was cut at once. */
enum { AT_ONCE = 1024 };
enum { SAMPLES = 8, GAP_SAMPLES = 16, BISECTIONS = 80, HIT_ULP = 8 };
/* Of time: a piece within it has no length. */
enum { RISE_ULP = 2 };

/*
 * A creeping slip goes against all of its friction. What turning it has left across is far more
 * than what two solutions for the same motion differ by.
 */
static void oppose_creeping(struct rb_modes *w)
{
	for (int k = 0; k < w->c->held_count; k++) {
		const rb_vec3 friction = rb_vec3_reject(w->force[k], w->contact_point[k].normal);

		if (w->c->held[k].creeps)
			w->contact[k].slip = rb_vec3_unit(rb_vec3_neg(friction),
			                                  w->contact[k].slip);
	}
}

bool rb_check_holds_otherwise(struct rb_modes *w, double t)
{
	const struct rb_cluster *c = w->c;
	const size_t count = (size_t)c->member_count;
	const rb_arena_mark here = rb_arena_here(w->l->arena);
	rb_vec3 *const moves = rb_arena_take(w->l->arena, count, sizeof *moves);
	struct rb_solver_body *found = NULL;
	double max = 0, off = 0;

	if (!moves)
		return false;
	rb_vec3 *const turns = rb_arena_take(w->l->arena, count, sizeof *turns);

	if (!turns)
		return false;
	memcpy(moves, w->linear, count * sizeof *moves);
	memcpy(turns, w->angular, count * sizeof *turns);
	oppose_creeping(w);
	if (!rb_rates_external(w, t, &max) || !rb_modes_solve_any(w, t, &found))
		return false;
	for (size_t k = 0; k < count; k++) {
		max = fmax(max, rb_vec3_max_abs(found[k].linear));
		off = fmax(off, rb_vec3_max_abs(rb_vec3_sub(found[k].linear, moves[k])));
		if (w->l->top)
			off = fmax(off, rb_model_reach(w->l->model, w->c->member[k]) *
			                        rb_vec3_max_abs(
							rb_vec3_sub(found[k].angular, turns[k])));
	}
	rb_arena_back(w->l->arena, here);
	return off <= RB_CHECK_OTHERWISE * max;
}

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

/* True if contact k keeps its mode's law within the uncertainty of the forces. */
static bool is_lawful(const struct rb_modes *w, int k)
{
	const struct rb_held *held = &w->c->held[k];
	const double *const inverse = w->l->model->inverse_mass;
	const double weight = w->max / (inverse[held->a] + inverse[held->b]);

	return rb_check_excess(w, k) <= fmax(clear * fmax(w->force_max, weight), w->doubt);
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

/* m: gap of the lowest held point of the pair whose first one is k; *end: past its last one. */
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

/*
 * m: how far the named point lies below the held ones of its pair, the first of which is k, at s.
 */
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
 * When the other point that has been found below the held ones at `s` came down to them (false
 * position, the older end halved: Dowell, Jarratt, BIT 11 (1971) 168). It is found by more than
 * rounding, and putting it right from there would lift the body at each impact, so that what rocks
 * does so without end.
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
	double above_s = s - 2 * below / rate, above;

	if (!(below > 0) || !(rate > 0))
		return s;
	for (;; above_s -= s - above_s) {
		above_s = fmax(above_s, 0);
		above = depth_at(w, k, &name, above_s, value);
		if (above <= 0)
			break;
		if (!(above_s > 0)) /* it never was above */
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
 * at `s` came down to them in this piece: what drifts aside as it falls has left its features once
 * it is deep. Leaves the state as it is at `s`.
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
 * True if another point of the pair, which is not held, lies below the held ones: the bodies touch
 * there. Asked once for each pair; held points may have drifted by integration.
 */
static bool is_hit(struct rb_modes *w, int k, double s, double *value)
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

	/* in a piece gaps are of differences: rounding of the sizes, wherever they are */
	return now.gap < low - HIT_ULP * DBL_EPSILON * rb_contact_point_largest(w->l, &now) &&
	       (approaches_elsewhere(w, k, end) || has_approached(w, k, end, &now, s, value));
}

/* The first contact that violates its mode at this state; -1: none. */
static int broken(struct rb_modes *w, double s, double *value)
{
	const double t = w->origin_s + s;
	const struct rb_cluster *c = w->c;
	bool inspected = false;

	for (int k = 0; k < c->held_count; k++) {
		const struct rb_held *held = &c->held[k];
		const struct rb_contact_point *m = &w->contact_point[k];

		w->slip_ends = false;
		w->hits = is_hit(w, k, s, value);
		if (held->creeps &&
		    rb_vec3_dot(m->velocity, w->contact[k].slip) > 2 * rb_event_set_creep(w->l, m))
			return k;
		if (m->on_rim != held->on_rim || rb_event_set_has_left(w->l, m) || w->hits)
			return k;
		if (!inspected && !is_lawful(w, k)) {
			if (!w->dense.open || !rb_check_holds_otherwise(w, t))
				return k;
			inspected = true;
		}
		/* without friction nothing happens where it turns back */
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

/* Points of one body stop slipping together: marks all whose slip is zero at s. */
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
 * True if a sticking contact needs more than its friction as soon as the piece begins. Where forces
 * are open, some distribution may hold at every moment while none holds on; with a friction of
 * thousands the solver's residue along the normal is much across it. Then it slips.
 */
static bool rest_ends(struct rb_modes *w, double s, int which, double *value)
{
	struct rb_held *const held = &w->c->held[which];
	const rb_vec3 n = w->contact_point[which].normal;

	if (held->slipping || w->hits || s > w->c->piece.length_s / AT_ONCE)
		return false;
	rb_gauss_values(&w->c->piece, s, value);
	if (!rb_rates_evaluate(w, w->origin_s + s, value))
		return false;
	const double normal_force = rb_vec3_dot(w->force[which], n);

	if (!(normal_force > 0) || !(rb_vec3_length(rb_vec3_reject(w->force[which], n)) >
	                             w->contact[which].friction * normal_force))
		return false;
	held->force = w->force[which];
	return true;
}

double rb_check_change_within(struct rb_modes *w, double *value)
{
	const double length = w->c->piece.length_s;
	double good = 0, bad = length;
	int which = -1;

	w->c->hits = false;
	for (int k = 1; k <= SAMPLES && which < 0; k++) {
		bad = k < SAMPLES ? length * k / SAMPLES : length;
		which = broken_at(w, bad, value);
		if (which < 0)
			good = bad;
	}
	if (which < 0 || w->l->status != RB_OK)
		return length;
	bool ends = w->slip_ends, hits = w->hits;
	for (int round = 0; round < BISECTIONS && bad - good > 0; round++) {
		const double middle = good + 0.5 * (bad - good);

		if (middle <= good || middle >= bad)
			break;
		const int now = broken_at(w, middle, value);
		if (now >= 0) {
			bad = middle;
			which = now;
			ends = w->slip_ends;
			hits = w->hits;
		} else {
			good = middle;
		}
	}
	if (hits)
		bad = touch_time(w, which, bad, value);
	if (ends)
		end_slips(w, bad, value);
	w->c->held[which].ending = ends || rest_ends(w, bad, which, value);
	w->c->hits = hits;
	w->c->hit_a = w->c->held[which].a;
	w->c->hit_b = w->c->held[which].b;
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
	return !w->dense.open || !rb_check_holds_otherwise(w, w->origin_s) ||
	       !rb_rates_evaluate(w, w->origin_s, w->c->piece.start);
}

/* ---- limits and ropes of joints ---- */

/* A stop that is open, as it was at the sample before. */
struct seen_stop {
	int joint, stop;
	double gap, rate;
};

static struct rb_joint_stop stop_now(const struct rb_modes *w, const struct seen_stop *seen,
                                     double s)
{
	return rb_joint_rows_stop(&w->joints, seen->joint, seen->stop, w->origin_s + s);
}

static struct rb_joint_stop stop_at(struct rb_modes *w, const struct seen_stop *seen, double s,
                                    double *value)
{
	rb_gauss_values(&w->c->piece, s, value);
	rb_rates_poses(w, value);
	return stop_now(w, seen, s);
}

/* Where a rate that falls before and rises after changes its sign, s. */
static double turning_point(struct rb_modes *w, const struct seen_stop *seen, double low,
                            double high, double *value)
{
	for (int round = 0; round < BISECTIONS; round++) {
		const double middle = low + 0.5 * (high - low);

		if (middle <= low || middle >= high)
			break;
		if (stop_at(w, seen, middle, value).rate < 0)
			low = middle;
		else
			high = middle;
	}
	return high;
}

/* Where the gap closes, s: the first moment at which it is found to be negative. */
static double closing_time(struct rb_modes *w, const struct seen_stop *seen, double good,
                           double bad, double *value)
{
	for (int round = 0; round < BISECTIONS; round++) {
		const double middle = good + 0.5 * (bad - good);

		if (middle <= good || middle >= bad)
			break;
		if (stop_at(w, seen, middle, value).gap < 0)
			bad = middle;
		else
			good = middle;
	}
	return bad;
}

/*
 * May the gap close between two samples: is it closed at the second one, or does it dip below zero
 * where the tangents meet?
 */
static bool may_close(const struct seen_stop *before, const struct rb_joint_stop *now, double time)
{
	const double low = before->rate, high = now->rate;

	if (now->gap < -now->band)
		return true;
	if (!(low < 0) || !(high > 0))
		return false;
	return before->gap + low * (now->gap - before->gap - high * time) / (low - high) < 0;
}

/* Where it closes within (from, to], s; INFINITY: nowhere beyond rounding. */
static double closed_within(struct rb_modes *w, const struct seen_stop *before,
                            const struct rb_joint_stop *now, double from, double to, double *value)
{
	if (now->gap < -now->band)
		return closing_time(w, before, from, to, value);
	const double least_s = turning_point(w, before, from, to, value);
	const struct rb_joint_stop least = stop_at(w, before, least_s, value);

	return least.gap < -least.band ? closing_time(w, before, from, least_s, value)
	                               : (double)INFINITY;
}

/* Stops that are open; NULL and l->status: no memory. */
static struct seen_stop *open_stops(const struct rb_modes *w, int *count)
{
	struct rb_located *l = w->l;
	struct seen_stop *const seen = rb_arena_take(
		l->arena, 2 * (size_t)w->joints.joint_count + 1, sizeof *seen);

	*count = 0;
	if (!seen)
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for joints");
	for (int k = 0; seen && k < w->joints.joint_count; k++)
		for (int stop = RB_STOP_LOW; stop < RB_JOINT_PARTS_HELD; stop++) {
			const int joint = w->joints.joint[k];

			if (rb_joint_rows_has_stop(&l->model->joints->joint[joint], stop) &&
			    l->drive_mode[RB_JOINT_PARTS_HELD * joint + stop] != RB_DRIVE_HELD)
				seen[(*count)++] = (struct seen_stop){.joint = joint, .stop = stop};
		}
	return seen;
}

/*
 * A stop that touches and closes as soon as the piece begins, while it parts, rises less than gaps
 * round by: it may hold from then on, or it would come to touch for ever.
 */
static void end_rise(struct rb_modes *w, const struct seen_stop *stop, double s, double *value)
{
	const struct rb_joint_stop now = stop_at(w, stop, s, value);

	if (now.gap < 0 && now.gap >= -now.band && now.rate > 0)
		w->l->drive_next[RB_JOINT_PARTS_HELD * stop->joint + stop->stop] = RB_DRIVE_REACHED;
}

double rb_check_stops_within(struct rb_modes *w, double length, double *value)
{
	const rb_arena_mark here = rb_arena_here(w->l->arena);
	int count;
	struct seen_stop *const seen = open_stops(w, &count);
	double end = (double)INFINITY;

	for (int k = 0; k <= GAP_SAMPLES && count > 0 && isinf(end); k++) {
		const double before = length * (k - 1) / GAP_SAMPLES;
		const double s = k < GAP_SAMPLES ? length * k / GAP_SAMPLES : length;

		rb_gauss_values(&w->c->piece, s, value);
		rb_rates_poses(w, value);
		for (int i = 0; i < count; i++) {
			const struct rb_joint_stop now = stop_now(w, &seen[i], s);
			const bool near = k > 0 && may_close(&seen[i], &now, s - before);

			if (near)
				end = fmin(end, closed_within(w, &seen[i], &now, before, s, value));
			if (near) {
				rb_gauss_values(&w->c->piece, s, value);
				rb_rates_poses(w, value);
			}
			seen[i].gap = now.gap;
			seen[i].rate = now.rate;
		}
	}
	if (end <= RISE_ULP * DBL_EPSILON * w->origin_s)
		for (int i = 0; i < count; i++)
			end_rise(w, &seen[i], end, value);
	rb_arena_back(w->l->arena, here);
	return fmin(end, length);
}

/* ---- what of joints holds ---- */

/* N: forces of a stop below this share of it are rounding. */
static double weight_of(const struct rb_modes *w, const struct rb_joint_row *row)
{
	const double *const inverse = w->l->model->inverse_mass;
	const double a = row->a >= 0 ? inverse[w->c->member[row->a]] : 0;
	const double b = row->b >= 0 ? inverse[w->c->member[row->b]] : 0;
	double max = w->max / (a + b);

	for (int k = 0; k < w->joints.count; k++)
		max = fmax(max, fabs(w->multiplier[k]));
	return max;
}

/* rad/s^2, m/s^2: by how much the free coordinate is accelerated against what is followed. */
static double off_acceleration(const struct rb_modes *w, int k)
{
	struct rb_joint_spring_row spring;

	if (!rb_joint_rows_spring(&w->joints, k, w->time_s, &spring))
		return 0;
	const struct rb_coupled_row row = rb_joint_rows_coupled(&spring.row);

	return rb_coupled_felt(&row, w->linear, w->angular) + spring.row.bias -
	       rb_follow_at(w->l, spring.row.joint, w->time_s, false).acceleration;
}

/*
 * On its way back at a bound: does the motor of the k-th joint, which follows, need its share to
 * brake from here on, of what it has beside the force that keeps the rate as it is? Forces are
 * linear in accelerations: that one follows from the bound and from what braking needs. Leaves
 * forces as if it braked.
 */
static bool brakes(struct rb_modes *w, int k, const struct rb_joint_off *off, const double *value)
{
	struct rb_located *l = w->l;
	const int which = w->joints.joint[k];
	signed char *const mode = &l->drive_mode[RB_JOINT_PARTS_HELD * which + RB_DRIVE_MOTOR];
	const signed char now = *mode;
	/* another look may have left other forces */
	const bool known = rb_rates_evaluate(w, w->time_s, value);
	const double pushed = now * off_acceleration(w, k);
	const double braked = now * off->rate * off->rate / (2 * off->value);
	double needed = -1; /* of the bound, to brake: with all of it, it pushes */

	*mode = RB_DRIVE_HELD;
	rb_follow_begin_return(l, which, w->time_s, off->value, off->rate);
	const bool good = known && rb_rates_evaluate(w, w->time_s, value);
	for (int r = 0; r < w->joints.count && good; r++) {
		const struct rb_joint_row *row = &w->joints.row[r];

		if (row->joint == which && row->drive == RB_DRIVE_MOTOR)
			needed = -now * w->multiplier[r] / rb_joint_rows_bound(&w->joints, row);
	}
	*mode = now;
	rb_follow_end_return(l, which);
	const double kept = needed + (needed + 1) * braked / (pushed - braked);

	return needed >= kept + rb_follow_brake * (1 - kept);
}

/*
 * Of a motor that follows, at a bound: the mode that comes then; KEEPS: it goes on. A stop that
 * holds leaves nothing to brake: what comes back to it does so by what is followed.
 */
static signed char follow_then(struct rb_modes *w, int k, const double *value)
{
	const int which = w->joints.joint[k];
	const int mode = w->l->drive_mode[RB_JOINT_PARTS_HELD * which + RB_DRIVE_MOTOR];

	if (mode != RB_DRIVE_LOW && mode != RB_DRIVE_HIGH)
		return RB_DRIVE_KEEPS;
	const struct rb_joint_off off = rb_joint_drives_off(&w->joints, which, w->time_s);

	if (rb_joint_off_ends(&off, mode))
		return mode == RB_DRIVE_LOW ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
	if (!w->goes_on && w->l->drive_next[RB_JOINT_PARTS_HELD * which + RB_DRIVE_MOTOR] == mode)
		return RB_DRIVE_KEEPS;
	return !rb_joint_drives_stopped(w->l, which) && mode * off.value < -off.band &&
	                       mode * off.rate > off.noise && brakes(w, k, &off, value)
	               ? RB_DRIVE_REACHED
	               : RB_DRIVE_KEEPS;
}

/* Has a drive, off by `v`, come to its speed? Where loads balance it, its rate is rounding. */
static bool has_reached(const struct rb_modes *w, const struct rb_joint_spring_row *spring,
                        int mode, double v)
{
	const int which = spring->row.joint;
	const struct rb_joint *joint = &w->l->model->joints->joint[which];
	const double lever = rb_linkage_turns(&joint->link) ? joint->size : 1;
	const struct rb_coupled_row row = rb_joint_rows_coupled(&spring->row);
	const double gains = rb_coupled_felt(&row, w->linear, w->angular) + spring->row.bias;

	return (mode == RB_DRIVE_LOW || mode == RB_DRIVE_HIGH) && mode * v > 0 &&
	       (mode * gains * lever > clear * w->max ||
	        mode * v > rb_joint_drives_noise(&w->joints, which, w->time_s));
}

/*
 * The mode that a drive has no more at this state (its place among those that come next), and what
 * it has then; NULL: all hold.
 */
static signed char *broken_drive(struct rb_modes *w, const double *value, signed char *then)
{
	const struct rb_located *l = w->l;

	for (int k = 0; k < w->joints.count; k++) {
		const struct rb_joint_row *row = &w->joints.row[k];
		const bool stop = rb_joint_rows_is_stop(row);
		const bool holds = row->drive < 0 ||
		                   (stop ? w->multiplier[k] >= -clear * weight_of(w, row)
		                         : fabs(w->multiplier[k]) <=
		                                    rb_joint_rows_bound(&w->joints, row) *
		                                            (1 + clear));

		if (holds)
			continue;
		*then = stop ? RB_STOP_OPEN : w->multiplier[k] > 0 ? RB_DRIVE_HIGH : RB_DRIVE_LOW;
		/* of forces that are open, others than the smallest may do */
		if (w->dense.open && rb_check_holds_otherwise(w, w->time_s))
			break;
		return &l->drive_next[RB_JOINT_PARTS_HELD * row->joint + row->drive];
	}
	for (int k = 0; k < w->joints.joint_count; k++) {
		const int which = w->joints.joint[k];
		struct rb_joint_spring_row spring;

		if (rb_joint_drives_stopped(l, which) ||
		    !rb_joint_rows_spring(&w->joints, k, w->time_s, &spring))
			continue;
		for (int kind = 0; kind < RB_JOINT_DRIVES; kind++) {
			const struct rb_joint_drive drive = rb_joint_rows_drive_now(l, which, kind);
			const int part = RB_JOINT_PARTS_HELD * which + kind;
			const double v = spring.row.velocity - drive.speed;

			if (!(drive.max > 0) || isnan(v))
				continue;
			*then = RB_DRIVE_REACHED;
			if (has_reached(w, &spring, l->drive_mode[part], v))
				return &l->drive_next[part];
		}
	}
	/* last, since looking at what brakes leaves other forces */
	for (int k = 0; k < w->joints.joint_count; k++) {
		const int which = w->joints.joint[k];

		if (!rb_follow_has(l, which) ||
		    !(rb_joint_rows_drive_now(l, which, RB_DRIVE_MOTOR).max > 0))
			continue;
		*then = follow_then(w, k, value);
		if (*then != RB_DRIVE_KEEPS)
			return &l->drive_next[RB_JOINT_PARTS_HELD * which + RB_DRIVE_MOTOR];
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
	signed char *which = NULL, then = 0;

	if (!has_held(w))
		return length;
	for (int k = 1; k <= SAMPLES && !which; k++) {
		bad = k < SAMPLES ? length * k / SAMPLES : length;
		which = broken_drive_at(w, bad, value, &then);
		if (!which)
			good = bad;
	}
	if (!which || w->l->status != RB_OK)
		return length;
	for (int round = 0; round < BISECTIONS && bad - good > 0; round++) {
		const double middle = good + 0.5 * (bad - good);
		signed char mode;

		if (middle <= good || middle >= bad)
			break;
		signed char *const now = broken_drive_at(w, middle, value, &mode);
		if (now) {
			bad = middle;
			which = now;
			then = mode;
		} else {
			good = middle;
		}
	}
	*which = then;
	return bad;
}
