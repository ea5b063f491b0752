/* SPDX-License-Identifier: MIT */
#include "event/integrate.h"

#include <float.h>
#include <string.h>

#include "base/memory.h"
#include "event/account.h"
#include "event/jam.h"
#include "event/landing.h"
#include "event/modes.h"
#include "event/pull.h"
#include "event/set.h"
#include "event/sizes.h"
#include "event/tell.h"
#include "event/work.h"

/* Of the sizes of position and velocity, per step; rounding is below it. */
static const double tolerance = 3e-14;
/* Shares of forces by which a mode is seen to have ended, so that what follows does not see it go on. */
static const double clear = 1e-11;
/* Accelerations below this share of the pulls are what the solver leaves: of what stands, and of what slides on. */
static const double still_share = 1e-12, rounding_share = 16 * DBL_EPSILON;
/* Share of forces up to which the solver's residue may be taken for a mode that holds. */
static const double doubtful = 1e-8;
/* Share of accelerations by which two solutions for the same motion differ. */
static const double otherwise = 1e-10;

/* Share of a column by which it is told from others, where that leads to forces that pull. */
static const double nearly_open = 1e-6;
/* A piece that is cut at less than this part of it was cut at once. */
enum { AT_ONCE = 1024 };
enum { LOOKS = 8, BISECTIONS = 80, HIT_ULP = 8 };

/* ---- the problem that math/gauss sees ---- */

static void read_pose(struct rb_modes *w, int k, const double *value)
{
	const struct rb_located *l = w->l;
	const int i = w->c->member[k];
	const double *v = value + (size_t)k * (size_t)w->row;
	struct rb_pose *pose = &w->pose[k];

	pose->position = w->base[k];
	pose->rest = (rb_vec3){0, 0, 0};
	rb_arc_move(pose, rb_vec3_from(v + RB_ROW_POSITION));
	pose->velocity = rb_vec3_from(v + RB_ROW_VELOCITY);
	pose->spin = (rb_vec3){0, 0, 0};
	pose->orientation = l->model->orientation[i];
	if (l->top) {
		pose->orientation = rb_quat_unit(rb_quat_from(v + RB_ROW_ORIENTATION));
		pose->spin = rb_vec3_from(v + RB_ROW_SPIN);
	}
	pose->origin = pose->position;
	if (l->model->center_of_mass)
		pose->origin = rb_vec3_sub(
			pose->position,
			rb_quat_rotate(pose->orientation, l->model->center_of_mass[i]));
}

/*
 * Of a cluster that stands, what the forces of its contacts leave is their rounding: static means static, also under
 * forces that are looked at again and again. Of one that slides on, so is what is no more than rounding; it would grow.
 */
static void stand_still(struct rb_modes *w, double pull)
{
	bool stands = true;

	for (int k = 0; k < w->c->member_count; k++)
		stands = stands && rb_vec3_max_abs(w->pose[k].velocity) == 0;
	const double most = pull * (stands ? still_share : rounding_share);
	for (int k = 0; k < w->c->member_count; k++) {
		const double radius = rb_model_reach(w->l->model, w->c->member[k]);

		if (rb_vec3_max_abs(w->pose[k].spin) > 0 || rb_vec3_max_abs(w->linear[k]) > most ||
		    rb_vec3_max_abs(w->angular[k]) * radius > most)
			return;
	}
	for (int k = 0; k < w->c->member_count; k++)
		w->linear[k] = w->angular[k] = (rb_vec3){0, 0, 0};
}

/* Accelerations apart from contacts, and the largest. */
static bool pulls(struct rb_modes *w, double t, double *most)
{
	struct rb_located *l = w->l;
	const struct rb_view view = {
		.pose = w->pose, .time_s = t, .active_s = w->origin_s, .parts = w->parts};

	*most = 0;
	for (int k = 0; k < w->c->member_count; k++)
		rb_pull_at(l, w->c->member[k], &w->pose[k], &view, &w->linear[k], &w->angular[k]);
	for (int k = 0; k < w->c->member_count; k++)
		*most = fmax(*most, rb_vec3_max_abs(w->linear[k]));
	return l->status == RB_OK;
}

/* Of members without contacts, at their surfaces, and of what contacts' normals and arms make. */
static double largest_acceleration(const struct rb_modes *w)
{
	double most = 0;

	for (int k = 0; k < w->c->member_count; k++)
		most = fmax(most, rb_vec3_length(w->linear[k]) +
		                          rb_vec3_length(w->angular[k]) *
		                                  w->l->model->shape[w->c->member[k]].radius);
	for (int k = 0; k < w->c->held_count; k++)
		most = fmax(most, rb_vec3_length(w->contact[k].bias));
	return most;
}

/* What a look has cost; what stands is looked at a few times, and then not for long. False: it is too much. */
static bool count_look(struct rb_modes *w)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;

	if (!rb_modes_move(w))
		return true;
	l->products += c->held_count > 0 ? (uint64_t)w->dense.products +
	                                           RB_LOCATED_LOOK * (uint64_t)c->held_count
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

/* Poses, forces of contacts and accelerations at `t`. */
static bool evaluate(struct rb_modes *w, double t, const double *value)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;
	double pull;

	w->time_s = t;
	for (int k = 0; k < c->member_count; k++)
		read_pose(w, k, value);
	if (!pulls(w, t, &pull))
		return false;
	for (int k = 0; k < c->held_count; k++) {
		const struct rb_held *held = &c->held[k];
		const int a = rb_modes_place(w, held->a), b = rb_modes_place(w, held->b);
		const struct rb_pose pose_a = a >= 0 ? w->pose[a] : rb_arc_pose(l, held->a, t);
		const struct rb_pose pose_b = b >= 0 ? w->pose[b] : rb_arc_pose(l, held->b, t);

		if (rb_set_is_single(l, held->a, held->b)) {
			w->meet[k] = rb_meet_poses(l, held->a, held->b, &pose_a, &pose_b);
		} else {
			const struct rb_meet_name name = rb_set_name(held);

			w->meet[k] = rb_meet_of(l, &name, &pose_a, &pose_b);
		}
		w->contact[k] = rb_mechanics_contact(l, &w->meet[k]);
		if (held->slipping)
			w->contact[k].friction = held->friction;
		/* a direction that is kept turns with the normal all the same */
		const rb_vec3 way = rb_vec3_max_abs(held->common) > 0 ? held->common : held->slip;
		w->contact[k].slip = rb_vec3_unit(rb_vec3_reject(way, w->meet[k].normal), way);
		if (held->slipping && !held->straight && !held->creeps) {
			const rb_vec3 slip = rb_vec3_reject(w->meet[k].velocity, w->meet[k].normal);
			const double speed = rb_vec3_length(slip);

			/* one that is just setting in goes where it sets in: its velocity is rounding */
			if (speed > 4 * w->contact[k].noise)
				w->contact[k].slip = rb_vec3_scale(1 / speed, slip);
		}
	}
	w->most = largest_acceleration(w);
	if (c->held_count == 0)
		return count_look(w);
	const bool solved = rb_modes_solve(w, t);
	if (!solved && !rb_modes_solve_any(w, t, NULL))
		return false;
	if (!rb_modes_press(w, w->force) || (solved && !rb_modes_refine(w, t)))
		return false;
	stand_still(w, pull);
	return count_look(w);
}

static enum rb_status rates(void *user, double t, const double *value, double *rate,
                            struct rb_error *err)
{
	struct rb_modes *w = user;
	const uint64_t products = w->l->products;

	const bool good = evaluate(w, t, value);
	if (*w->calls == w->counted) /* for the ledger alone */
		w->l->products = products;
	w->counted = *w->calls;
	if (!good)
		return w->l->status != RB_OK
		               ? w->l->status
		               : RB_FAIL(err, RB_ERR_MEMORY, "no memory for a cluster");
	for (int k = 0; k < w->c->member_count; k++) {
		const double *v = value + (size_t)k * (size_t)w->row;
		double *r = rate + (size_t)k * (size_t)w->row;

		rb_vec3_to(r + RB_ROW_POSITION, w->pose[k].velocity);
		rb_vec3_to(r + RB_ROW_VELOCITY, w->linear[k]);
		if (!w->l->top)
			continue;
		rb_vec3_to(r + RB_ROW_SPIN, w->angular[k]);
		if (w->l->unfelt[w->c->member[k]]) {
			rb_quat_to(r + RB_ROW_ORIENTATION, (rb_quat){0, 0, 0, 0});
			continue;
		}
		const rb_quat turn = {0, 0.5 * w->pose[k].spin.x, 0.5 * w->pose[k].spin.y,
		                      0.5 * w->pose[k].spin.z};
		rb_quat_to(r + RB_ROW_ORIENTATION,
		           rb_quat_multiply(turn, rb_quat_from(v + RB_ROW_ORIENTATION)));
	}
	return RB_OK;
}

static void enter_node(void *user, int node)
{
	const struct rb_modes *w = user;

	struct rb_entries rate;

	rb_work_rates(w, w->parts, w->time_s, &rate);
	memcpy(w->seen + (size_t)node * RB_ENTRIES, rate.row, sizeof rate.row);
}

/* ---- changes of mode ---- */

/*
 * Where modes leave forces open, those that were found may be outside the cones while others are within: are there forces
 * by the law that move all bodies as the modes do? They are then the forces.
 */
static bool holds_otherwise(struct rb_modes *w, double t)
{
	const struct rb_cluster *c = w->c;
	const size_t count = (size_t)c->member_count;
	const rb_arena_mark here = rb_arena_here(w->l->arena);
	rb_vec3 *const moves = rb_arena_take(w->l->arena, count, sizeof *moves);
	struct rb_joint_body *found;
	double most = 0, off = 0;

	if (!moves)
		return false;
	rb_vec3 *const turns = rb_arena_take(w->l->arena, count, sizeof *turns);

	if (!turns)
		return false;
	memcpy(moves, w->linear, count * sizeof *moves);
	memcpy(turns, w->angular, count * sizeof *turns);
	if (!pulls(w, t, &most) || !rb_modes_solve_any(w, t, &found))
		return false;
	for (size_t k = 0; k < count; k++) {
		most = fmax(most, rb_vec3_max_abs(found[k].linear));
		off = fmax(off, rb_vec3_max_abs(rb_vec3_sub(found[k].linear, moves[k])));
		if (w->l->top)
			off = fmax(off, rb_model_reach(w->l->model, w->c->member[k]) *
			                        rb_vec3_max_abs(
							rb_vec3_sub(found[k].angular, turns[k])));
	}
	rb_arena_back(w->l->arena, here);
	return off <= otherwise * most;
}

/* By how much the force of a contact does not go with its mode, N; below zero: it does. */
static double excess_of(const struct rb_modes *w, int k)
{
	const rb_vec3 n = w->meet[k].normal;
	const double push = rb_vec3_dot(w->force[k], n);

	if (w->c->held[k].slipping)
		return -push;
	return fmax(-push,
	            rb_vec3_length(rb_vec3_reject(w->force[k], n)) - w->contact[k].friction * push);
}

static bool is_lawful(const struct rb_modes *w, int k)
{
	const struct rb_held *held = &w->c->held[k];
	const double *const inverse = w->l->model->inverse_mass;
	const double weight = w->most / (inverse[held->a] + inverse[held->b]);

	return excess_of(w, k) <= fmax(clear * fmax(w->force_most, weight), w->doubt);
}

/* Does a pair approach at a point that is not one of its held ones, [first, end)? */
static bool approaches_elsewhere(const struct rb_modes *w, int first, int end)
{
	const struct rb_held *held = &w->c->held[first];
	const struct rb_touch_pair pair = {held->a, held->b, w->origin_s, w->meet[first].pose_a,
	                                   w->meet[first].pose_b};
	struct rb_meet all[RB_MEET_MAX];
	const int count = rb_touch_all(w->l, &pair, 0, all);

	for (int k = 0; k < count; k++) {
		bool known = rb_vec3_dot(all[k].velocity, all[k].normal) >=
		                     -rb_meet_noise(w->l, &all[k]) ||
		             rb_meet_passes(w->l, &all[k], w->origin_s);
		for (int i = first; i < end && !known; i++)
			known = rb_set_is_same_place(w->l, &all[k], &w->meet[i]);
		if (!known)
			return true;
	}
	return false;
}

/*
 * Asked of the first of a pair's points: is another, which is not held, below them? The bodies have come to touch there.
 * What is held may be off by what integration lets drift.
 */
static bool is_hit(const struct rb_modes *w, int k)
{
	const struct rb_meet *m = &w->meet[k];
	const struct rb_held *held = &w->c->held[k];
	double low = m->gap;
	int end = k + 1;

	if (rb_set_is_single(w->l, held->a, held->b) ||
	    (k > 0 && held[-1].a == held->a && held[-1].b == held->b))
		return false;
	for (; end < w->c->held_count; end++) {
		if (w->c->held[end].a != held->a || w->c->held[end].b != held->b)
			break;
		low = fmin(low, w->meet[end].gap);
	}
	if (rb_modes_move(w))
		w->l->products += RB_LOCATED_SEARCH;
	const struct rb_meet now = rb_meet_poses(w->l, held->a, held->b, &m->pose_a, &m->pose_b);

	/* in a piece gaps are of differences: rounding of the sizes, wherever they are */
	return now.gap < low - HIT_ULP * DBL_EPSILON * rb_meet_largest(w->l, &now) &&
	       approaches_elsewhere(w, k, end);
}

/* The first contact that does not keep its mode at this state, -1: all do. */
static int broken(struct rb_modes *w, double t)
{
	const struct rb_cluster *c = w->c;
	bool looked = false;

	for (int k = 0; k < c->held_count; k++) {
		const struct rb_held *held = &c->held[k];
		const struct rb_meet *m = &w->meet[k];

		w->slip_ends = false;
		w->hits = is_hit(w, k);
		if (held->creeps &&
		    rb_vec3_dot(m->velocity, w->contact[k].slip) > 2 * rb_set_creep(w->l, m))
			return k;
		if (m->on_rim != held->on_rim || rb_set_has_left(w->l, m) || w->hits)
			return k;
		if (!looked && !is_lawful(w, k)) {
			if (!w->dense.open || !holds_otherwise(w, t))
				return k;
			looked = true;
		}
		w->slip_ends = held->slipping && (held->straight || held->creeps) &&
		               rb_vec3_dot(m->velocity, w->contact[k].slip) < 0;
		if (w->slip_ends)
			return k;
	}
	return -1;
}

static int broken_at(struct rb_modes *w, double s, double *value)
{
	rb_gauss_values(&w->c->piece, s, value);
	return evaluate(w, w->origin_s + s, value) ? broken(w, w->origin_s + s) : -1;
}

/* Points of one body come to the end of their slip together: whose slip is nothing there has ended as well. */
static void end_slips(struct rb_modes *w, double s, double *value)
{
	rb_gauss_values(&w->c->piece, s, value);
	if (!evaluate(w, w->origin_s + s, value))
		return;
	for (int k = 0; k < w->c->held_count; k++) {
		struct rb_held *const held = &w->c->held[k];
		const struct rb_meet *m = &w->meet[k];

		if (held->slipping && (held->straight || held->creeps) &&
		    !rb_set_is_single(w->l, held->a, held->b))
			held->ending = rb_vec3_dot(m->velocity, w->contact[k].slip) <=
			               rb_meet_noise(w->l, m);
	}
}

/*
 * Does a contact that sticks need more than its friction as soon as the piece has begun? Where forces are open, there may be
 * some for which it holds, at every moment anew, and none that go on: so it slips.
 */
static bool rest_ends(struct rb_modes *w, double s, int which, double *value)
{
	struct rb_held *const held = &w->c->held[which];
	const rb_vec3 n = w->meet[which].normal;

	if (held->slipping || w->hits || s > w->c->piece.length_s / AT_ONCE || !w->dense.open)
		return false;
	rb_gauss_values(&w->c->piece, s, value);
	if (!evaluate(w, w->origin_s + s, value))
		return false;
	const double push = rb_vec3_dot(w->force[which], n);

	if (!(push > 0) || !(rb_vec3_length(rb_vec3_reject(w->force[which], n)) >
	                     w->contact[which].friction * push))
		return false;
	held->force = w->force[which];
	return true;
}

/* Where in the piece a mode ends first, seconds; the whole length if none does. */
static double change_within(struct rb_modes *w, double *value)
{
	const double length = w->c->piece.length_s;
	double good = 0, bad = length;
	int which = -1;

	w->c->hits = false;
	for (int k = 1; k <= LOOKS && which < 0; k++) {
		bad = k < LOOKS ? length * k / LOOKS : length;
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
	if (ends)
		end_slips(w, bad, value);
	w->c->held[which].ending = ends || rest_ends(w, bad, which, value);
	w->c->hits = hits;
	w->c->hit_a = w->c->held[which].a;
	w->c->hit_b = w->c->held[which].b;
	return bad;
}

/* Does a slip that was taken for straight turn aside within [0, s]? */
static bool turns_aside(struct rb_modes *w, double s, double *value)
{
	bool any = false;

	for (int k = 0; k < w->c->held_count; k++)
		any = any || w->c->held[k].straight;
	rb_gauss_values(&w->c->piece, s, value);
	if (!any || !evaluate(w, w->origin_s + s, value))
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

/* ---- a piece ---- */

size_t rb_integrate_room(int n)
{
	return (size_t)n * (3 + RB_GAUSS_NODES) + rb_gauss_room(n);
}

/* In the cluster's block, for a piece to come. */
static bool room(struct rb_modes *w, int n, double **value, double **scale, double **scratch)
{
	struct rb_cluster *c = w->c;
	const size_t size = rb_integrate_room(n);

	if (!rb_memory_reserve(&c->block, &c->block_capacity, size, sizeof *c->block) ||
	    !rb_account_room(w->l, c))
		return false;
	c->piece = (struct rb_gauss_piece){.n = n, .start = c->block, .coefficient = c->block + n};
	*scale = c->block + (size_t)n * (1 + RB_GAUSS_NODES);
	*value = *scale + n;
	*scratch = *value + n;
	return true;
}

/* All contacts stick after it, and the cluster is to be settled anew. False: it is no such case. */
static bool jams(struct rb_modes *w)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	const size_t n = (size_t)c->held_count + 1;
	double *const friction = rb_arena_take(l->arena, n, sizeof *friction);
	struct rb_jam jam = {.l = l,
	                     .meet = w->meet,
	                     .force = w->force,
	                     .friction = friction,
	                     .count = c->held_count,
	                     .pose = w->pose,
	                     .body_count = c->member_count,
	                     .impulse = rb_arena_take(l->arena, n, sizeof *jam.impulse),
	                     .linear = w->linear,
	                     .angular = w->angular,
	                     .scratch = rb_arena_take(l->arena, 3 * n, sizeof *jam.scratch)};
	bool slips = false;

	for (int k = 0; k < c->held_count; k++)
		slips = slips || c->held[k].slipping;
	if (!slips || !friction || !jam.impulse || !jam.scratch ||
	    !evaluate(w, w->origin_s, c->piece.start))
		return false;
	for (int k = 0; k < c->held_count; k++)
		friction[k] = w->contact[k].friction;
	if (!rb_jam_stop(&jam))
		return false;
	for (int k = 0; k < c->member_count; k++) {
		struct rb_pose pose = w->pose[k];
		const rb_vec3 none = {0, 0, 0};

		pose.velocity = rb_vec3_add(pose.velocity, w->linear[k]);
		pose.spin = rb_vec3_add(pose.spin, w->angular[k]);
		rb_arc_anchor(l, c->member[k], w->origin_s, &pose, none, none);
	}
	for (int k = 0; k < c->held_count; k++) {
		/* jam.scratch: what the impulses have added */
		rb_work_impact(l, &w->meet[k], jam.impulse[k], w->meet[k].velocity,
		               rb_vec3_add(w->meet[k].velocity, jam.scratch[k]));
		c->held[k].ending = c->held[k].slipping;
		rb_tell_impact(l, w->origin_s, &w->meet[k], jam.impulse[k], 0);
	}
	c->integrated = false;
	c->has_jammed = true;
	return true;
}

static void put_on_piece(struct rb_modes *w, double until_s)
{
	struct rb_located *l = w->l;
	const struct rb_gauss_piece *piece = &w->c->piece;

	for (int k = 0; k < w->c->member_count; k++) {
		const int first = k * w->row;
		double square = 0;

		for (int m = 0; m < 3; m++) {
			const double most = rb_gauss_rate_bound(piece, first + RB_ROW_VELOCITY + m);
			square += most * most;
		}
		l->piece[w->c->member[k]] = (struct rb_piece_of){.piece = *piece,
		                                                 .first = first,
		                                                 .base = w->base[k],
		                                                 .origin_s = w->origin_s,
		                                                 .until_s = until_s,
		                                                 .acceleration_most = sqrt(square)};
	}
}

static double next_switch(const struct rb_located *l, double t)
{
	for (int k = l->switch_next; k < l->switch_count; k++)
		if (l->switch_s[k] > t)
			return l->switch_s[k];
	return HUGE_VAL;
}

/* Where a driven body that one of the contacts leans on comes to the end of what is known of it. */
static double partners_end(const struct rb_modes *w)
{
	const double soon = w->origin_s * (1 + 4 * DBL_EPSILON);
	double end = HUGE_VAL;

	for (int k = 0; k < w->c->held_count; k++) {
		const int pair[2] = {w->c->held[k].a, w->c->held[k].b};

		for (int side = 0; side < 2; side++)
			if (rb_located_driven(w->l, pair[side]) &&
			    w->l->piece[pair[side]].until_s > soon)
				end = fmin(end, w->l->piece[pair[side]].until_s);
	}
	return end;
}

/* Are these other forces than those that settling has found? */
static bool are_others(const struct rb_modes *w)
{
	double off = 0, most = 0;

	for (int k = 0; k < w->c->held_count; k++) {
		const rb_vec3 n = w->meet[k].normal, found = w->c->held[k].force;

		most = fmax(most, rb_vec3_length(found));
		off = fmax(off, fabs(rb_vec3_dot(rb_vec3_sub(w->force[k], found), n)));
	}
	return off > nearly_open * most;
}

/*
 * Forces and accelerations at the beginning. Slips of which no direction is found that forces balance across do not creep:
 * they turn, however fast that is. And where these are not the forces that settling has found, points are one too many but
 * for next to nothing, which would leave the forces to rounding: they keep those, if the modes are as good with them.
 */
static bool begin_modes(struct rb_modes *w)
{
	bool creeps = false;

	const bool joined = rb_modes_join_slips(w);

	if (!evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	if (joined && !w->balanced) {
		rb_modes_part_slips(w);
		if (!evaluate(w, w->origin_s, w->c->piece.start))
			return false;
	}
	w->dense.least = are_others(w) ? nearly_open : 0;
	if (w->dense.least > 0 && !evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	if (w->dense.least > 0 && !(rb_modes_left(w, w->origin_s) <= otherwise * w->most)) {
		w->dense.least = 0;
		if (!evaluate(w, w->origin_s, w->c->piece.start))
			return false;
	}
	w->c->least = w->dense.least;
	for (int k = 0; k < w->c->held_count && !w->balanced; k++) {
		creeps = creeps || w->c->held[k].creeps;
		w->c->held[k].creeps = false;
	}
	if (creeps && !evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	for (int k = 0; k < w->c->held_count; k++)
		w->slow[k] = w->c->held[k].straight && rb_modes_is_slow(w, k, w->origin_s);
	return true;
}

static void run(struct rb_modes *w, double *value, double *scale, double *scratch)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	uint64_t calls = 0;
	struct rb_gauss_problem problem = {
		.n = c->piece.n,
		.rates = rates,
		.noise = l->model->features & RB_FEATURE_FIELD ? rb_modes_noise : NULL,
		.user = w,
		.scale = scale,
		.tolerance = tolerance,
		.visited = w->parts ? enter_node : NULL,
		/* a spring that is passed through pulls the other way at once; a field is the user's */
		.jumps = (l->model->features & (RB_FEATURE_SPRINGS | RB_FEATURE_FIELD)) != 0,
		.scratch = scratch,
		.calls = &calls};

	for (int k = 0; k < c->member_count; k++) {
		const struct rb_pose pose = rb_arc_pose(l, c->member[k], w->origin_s);
		double *const v = c->piece.start + (size_t)k * (size_t)w->row;

		w->base[k] = pose.position;
		rb_vec3_to(v + RB_ROW_POSITION, pose.rest);
		rb_vec3_to(v + RB_ROW_VELOCITY, pose.velocity);
		if (!l->top)
			continue;
		rb_quat_to(v + RB_ROW_ORIENTATION, pose.orientation);
		rb_vec3_to(v + RB_ROW_SPIN, pose.spin);
	}
	if (rb_landing_begin(w) || !begin_modes(w))
		return;
	for (int k = 0; k < c->held_count; k++) {
		c->held[k].force = w->force[k];
		w->force_most = fmax(w->force_most, rb_vec3_length(w->force[k]));
	}
	/*
	 * What has just been said to stick sticks: by so much the solver has not seen it slip. The next look is where that has
	 * grown.
	 */
	for (int k = 0; k < c->held_count; k++)
		w->doubt = fmax(w->doubt, 4 * fmin(excess_of(w, k), doubtful * w->force_most));
	const double guess = rb_sizes_of(w, scale);
	w->calls = &calls;
	w->scale = scale;
	if (!(c->try_s > 0))
		c->try_s = guess;
	/* never past the end of the run by more than it needs, nor over a switch of forces */
	const double room_s = fmin(fmin(next_switch(l, w->origin_s), partners_end(w)),
	                           fmax(l->end_s * (1 + 1e-9), w->origin_s + guess)) -
	                      w->origin_s;
	double length = 0;

	/* what is straight at the beginning may turn: on what turns itself, say */
	do {
		double try_s = fmin(c->try_s, room_s);
		const double tried = try_s;
		const bool cut = tried < c->try_s;
		const enum rb_status status = rb_gauss_step(&problem, w->origin_s, &try_s,
		                                            2 * DBL_EPSILON * w->origin_s,
		                                            &c->piece, l->err);

		if (status == RB_ERR_PHYSICS && l->status == RB_OK && c->held_count > 0 && jams(w))
			break;
		if (status != RB_OK) {
			l->status = status;
			break;
		}
		if (w->parts) {
			c->account.n = RB_ENTRIES;
			rb_gauss_integrate(&c->account, c->piece.length_s, w->seen);
		}
		/* room that was short says nothing of the motion, unless the step was shorter still */
		c->try_s = cut && c->piece.length_s >= tried ? fmax(c->try_s, try_s) : try_s;
		length = c->held_count > 0 ? change_within(w, value) : c->piece.length_s;
		c->is_cut = length < c->piece.length_s;
	} while (l->status == RB_OK &&
	         (turns_aside(w, length, value) || turns_aside(w, 0.5 * length, value)));
	l->world->frame_counts.body_steps += calls * (uint64_t)c->member_count;
	if (l->status != RB_OK || c->has_jammed)
		return;
	/* a piece ends at a moment that is later than its beginning */
	put_on_piece(w, fmax(w->origin_s + length, nextafter(w->origin_s, HUGE_VAL)));
}

/* What has been given up halfway has left the piece before: its members are where this one was to begin. */
static void stay(struct rb_modes *w)
{
	struct rb_gauss_piece *piece = &w->c->piece;

	memset(piece->coefficient, 0, (size_t)piece->n * RB_GAUSS_NODES * sizeof(double));
	piece->length_s = 1;
	put_on_piece(w, w->origin_s);
}

void rb_integrate_piece(struct rb_located *l, int cluster, double t)
{
	struct rb_modes w = {
		.l = l, .c = &l->cluster[cluster], .origin_s = t, .row = rb_located_row(l)};
	const rb_arena_mark here = rb_arena_here(l->arena);
	const int count = w.c->member_count;
	double *value, *scale, *scratch;

	rb_account_cluster(l, cluster, t);
	w.c->anchor_s = w.c->account_s = t;
	if (!l->piece)
		l->piece = rb_memory_take((size_t)l->n, sizeof *l->piece);
	int *kept = NULL;
	if (l->piece && room(&w, count * w.row, &value, &scale, &scratch) && rb_modes_room(&w))
		kept = rb_modes_take_places(l, w.c);
	if (!kept) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory to integrate %d bodies",
		                    count);
		return;
	}
	run(&w, value, scale, scratch);
	if (l->status != RB_OK)
		stay(&w);
	rb_modes_give_back_places(l, w.c, kept);
	rb_arena_back(l->arena, here);
}

bool rb_integrate_forces(struct rb_located *l, int cluster, double t, rb_vec3 *force)
{
	struct rb_cluster *const c = &l->cluster[cluster];
	struct rb_modes w = {.l = l,
	                     .c = c,
	                     .origin_s = l->piece[c->member[0]].origin_s,
	                     .row = rb_located_row(l)};
	const rb_arena_mark here = rb_arena_here(l->arena);
	/* a look that somebody asks for decides nothing */
	const uint64_t products = l->products;
	double *const value = rb_arena_take(l->arena, (size_t)c->piece.n + 1, sizeof *value);
	const int *const kept = value && rb_modes_room(&w) ? rb_modes_take_places(l, c) : NULL;
	bool good = kept != NULL;

	if (good) {
		for (int k = 0; k < c->member_count; k++)
			w.base[k] = l->piece[c->member[k]].base;
		w.dense.least = c->least;
		rb_gauss_values(&c->piece, t - w.origin_s, value);
		good = evaluate(&w, t, value);
		memcpy(force, w.force, (size_t)c->held_count * sizeof *force);
		if (good && w.dense.open && !rb_modes_are_lawful(&w) && holds_otherwise(&w, t))
			memcpy(force, w.force, (size_t)c->held_count * sizeof *force);
		rb_modes_give_back_places(l, c, kept);
	}
	if (l->status == RB_ERR_PHYSICS) /* too much to look at */
		l->status = RB_OK;
	l->products = products;
	rb_arena_back(l->arena, here);
	return good;
}
