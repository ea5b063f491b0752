/* SPDX-License-Identifier: MIT */
#include "located/integrate.h"

#include "base/error.h"

#include <float.h>
#include <string.h>

#include "base/memory.h"
#include "located/account.h"
#include "located/event_records.h"
#include "located/failure.h"
#include "located/follow.h"
#include "located/rim_landing.h"
#include "located/mode_checks.h"
#include "located/piece_warm_start.h"
#include "located/painleve.h"
#include "located/rates.h"
#include "located/event_set.h"
#include "located/singular.h"
#include "located/piece_scales.h"
#include "located/work.h"
#include "located/mechanics.h"
#include "math/gauss_newton.h"

/* Of the sizes of position and velocity, per step; rounding is below it. */
static const double tolerance = 3e-14;
/* Share of a column by which it is told from others, where that leads to forces that pull. */
static const double nearly_open = 1e-6;
/*
 * Share of the time in which loads would move a member by its size: pieces of joined bodies are
 * within 2^-8 of it. And how many more shorter than this share than others are too many.
 */
static const double creeping = 0x1p-20;
/* Of a piece, after which a slip has turned aside by no more than noise: it does by the square. */
static const double shorter = 0.25;
enum { CREPT_MAX = 256 };

/* What a piece to come needs. */
struct columns {
	double *value, *scale, *guess, *scratch; /* in the cluster's block; guess: [NODES][n] */
	int *rate_row;                           /* [n] */
};

size_t rb_integrate_kept_size(int n)
{
	return (size_t)n * (2 + RB_GAUSS_NODES);
}

size_t rb_integrate_scratch_size(int n)
{
	return rb_integrate_kept_size(n) + (size_t)n * (2 + RB_GAUSS_NODES) +
	       rb_gauss_scratch_size(n);
}

void rb_integrate_lay_out(struct rb_cluster *c, int n)
{
	c->piece.n = n;
	c->piece.start = c->block;
	c->piece.coefficient = c->block + n;
	c->piece.rest = c->piece.coefficient + (size_t)n * RB_GAUSS_NODES;
}

static bool take_columns(struct rb_modes *w, struct columns *columns)
{
	struct rb_cluster *c = w->c;
	const int n = c->member_count * w->row;
	const size_t size = rb_integrate_scratch_size(n);

	if (!rb_piece_warm_start_reserve(w->l) ||
	    !rb_memory_reserve(&c->block, &c->block_capacity, size, sizeof *c->block) ||
	    !rb_account_reserve(w->l, c) || !rb_modes_reserve(w))
		return false;
	columns->rate_row = rb_arena_take(w->l->arena, (size_t)n, sizeof *columns->rate_row);
	columns->scale = c->block + rb_integrate_kept_size(n);
	columns->value = columns->scale + n;
	columns->guess = columns->value + n;
	columns->scratch = columns->guess + (size_t)n * RB_GAUSS_NODES;
	return columns->rate_row != NULL;
}

static void start_rows(const struct rb_modes *w, int k, int *rate_row)
{
	struct rb_located *l = w->l;
	const int first = k * w->row;
	const struct rb_pose pose = rb_arc_pose(l, w->c->member[k], w->origin_s);
	const struct rb_piece_warm_start *past = rb_piece_warm_start_at(l, w->c->member[k],
	                                                                w->origin_s);
	double *const v = w->c->piece.start + first, *const rest = w->c->piece.rest + first;

	w->base[k] = pose.position;
	for (int m = 0; m < w->row; m++) {
		rest[m] = 0;
		rate_row[first + m] = m < RB_PIECE_VELOCITY ? first + RB_PIECE_VELOCITY + m : -1;
		if (m >= RB_PIECE_ORIENTATION && m < RB_PIECE_SPIN)
			rate_row[first + m] = RB_GAUSS_QUICK;
	}
	rb_vec3_to(v + RB_PIECE_POSITION, pose.rest);
	rb_vec3_to(v + RB_PIECE_VELOCITY, pose.velocity);
	if (l->top) {
		rb_quat_to(v + RB_PIECE_ORIENTATION, pose.orientation);
		rb_vec3_to(v + RB_PIECE_SPIN, pose.spin);
	}
	if (!past)
		return;
	if (rb_vec3_max_abs(rb_vec3_sub(past->position, pose.position)) == 0 &&
	    rb_vec3_max_abs(rb_vec3_sub(past->left_out, pose.rest)) == 0)
		memcpy(rest, past->rest, 3 * sizeof *rest);
	for (int m = RB_PIECE_VELOCITY; m < w->row; m++)
		if (v[m] == past->value[m])
			rest[m] = past->rest[m];
}

/*
 * The rates of a piece that all members come from, at this moment. Where it has ended with a mode,
 * or by an impact, what they jump by is seen at the beginning (math/gauss).
 */
static struct rb_gauss_guess guess_of(const struct rb_modes *w, double *to)
{
	const struct rb_gauss_guess none = {0};
	const struct rb_piece_warm_start *const first = rb_piece_warm_start_at(
		w->l, w->c->member[0], w->origin_s);
	const size_t n = (size_t)(w->c->member_count * w->row), row = (size_t)w->row;

	if (!first)
		return none;
	for (int k = 0; k < w->c->member_count; k++) {
		const struct rb_piece_warm_start *past = rb_piece_warm_start_at(
			w->l, w->c->member[k], w->origin_s);

		if (!past || past->origin_s != first->origin_s || past->length_s != first->length_s)
			return none;
		for (size_t p = 0; p < RB_GAUSS_NODES; p++)
			memcpy(to + p * n + (size_t)k * row, past->coefficient[p],
			       row * sizeof *to);
	}
	return (struct rb_gauss_guess){.coefficient = to,
	                               .length_s = first->length_s,
	                               .from_s = first->left_s - first->origin_s};
}

/*
 * Its one pair rebounds by the law of eccentric impacts, all its points as one, as where a slip
 * begins that no force allows (located/tangential_impact): its slip may not stop but turn. False:
 * there are several pairs, or there is such a force.
 */
static bool rebounds(struct rb_modes *w)
{
	struct rb_located *const l = w->l;
	const struct rb_contact_point *const first = &w->contact_point[0];
	const rb_vec3 none = {0, 0, 0};
	bool pushes = false;
	rb_vec3 change;

	for (int k = 0; k < w->c->held_count; k++) {
		if (w->contact_point[k].a != first->a || w->contact_point[k].b != first->b)
			return false;
		pushes = pushes || rb_vec3_dot(w->force[k], w->contact_point[k].normal) > 0;
	}
	if (!pushes)
		return false;
	struct rb_contact_point m = rb_painleve_middle(l, first, w->force, w->c->held_count);
	rb_vec3 impulse = rb_painleve_impulse(l, &m, &change);
	if (!(rb_vec3_dot(impulse, m.normal) > 0)) {
		const int alone = rb_painleve_alone(l, first, w->force, w->c->held_count);

		if (alone < 0)
			return false;
		m = w->contact_point[alone];
		impulse = rb_painleve_impulse(l, &m, &change);
	}
	for (int k = 0; k < w->c->member_count; k++) {
		const int i = w->c->member[k];
		struct rb_pose pose = w->pose[k];
		const bool is_a = i == m.a;

		if (is_a || i == m.b) {
			const struct rb_mechanics_change by = rb_mechanics_change(
				l, i, pose.orientation, is_a ? m.arm_a : m.arm_b,
				is_a ? rb_vec3_neg(impulse) : impulse);

			pose.velocity = rb_vec3_add(pose.velocity, by.linear);
			pose.spin = rb_vec3_add(pose.spin, by.angular);
		}
		rb_arc_anchor(l, i, w->origin_s, &pose, none, none);
	}
	rb_work_impact(l, &m, impulse, m.velocity, rb_vec3_add(m.velocity, change));
	rb_record_impact(l, w->origin_s, &m, impulse, 0);
	w->c->integrated = false;
	w->c->has_jumped = w->c->hits = true;
	w->c->hit_a = m.a;
	w->c->hit_b = m.b;
	return true;
}

/*
 * All contacts stick after it, or one is slower, and the cluster is to be resolved anew. False: it
 * is no such case.
 */
static bool is_painleve(struct rb_modes *w)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	const size_t n = (size_t)c->held_count + 1;
	double *const friction = rb_arena_take(l->arena, n, sizeof *friction);
	struct rb_painleve painleve = {
		.l = l,
		.contact_point = w->contact_point,
		.force = w->force,
		.friction = friction,
		.count = c->held_count,
		.pose = w->pose,
		.body_count = c->member_count,
		.impulse = rb_arena_take(l->arena, n, sizeof *painleve.impulse),
		.linear = w->linear,
		.angular = w->angular,
		.scratch = rb_arena_take(l->arena, 3 * n, sizeof *painleve.scratch)};
	bool slips = false;

	for (int k = 0; k < c->held_count; k++)
		slips = slips || c->held[k].slipping;
	/* its impulses know no joints: where friction jams a mechanism the piece fails */
	if (w->joints.count > 0 || !slips || !friction || !painleve.impulse || !painleve.scratch ||
	    !rb_rates_evaluate(w, w->origin_s, c->piece.start))
		return false;
	for (int k = 0; k < c->held_count; k++)
		friction[k] = w->contact[k].friction;
	const bool stops = rb_painleve_stop(&painleve);
	if (!stops && rebounds(w))
		return true;
	if (!stops && !rb_painleve_slow(&painleve))
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
		rb_work_impact(l, &w->contact_point[k], painleve.impulse[k],
		               w->contact_point[k].velocity,
		               rb_vec3_add(w->contact_point[k].velocity, painleve.scratch[k]));
		c->held[k].ending = stops && c->held[k].slipping;
		rb_record_impact(l, w->origin_s, &w->contact_point[k], painleve.impulse[k], 0);
	}
	c->integrated = false;
	c->has_jumped = true;
	c->hits = !stops;
	c->hit_a = w->contact_point[0].a;
	c->hit_b = w->contact_point[0].b;
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
			const double max = rb_gauss_rate_bound(piece,
			                                       first + RB_PIECE_VELOCITY + m);
			square += max * max;
		}
		l->piece[w->c->member[k]] = (struct rb_piece_of){.piece = *piece,
		                                                 .first = first,
		                                                 .base = w->base[k],
		                                                 .origin_s = w->origin_s,
		                                                 .until_s = until_s,
		                                                 .acceleration_max = sqrt(square)};
	}
}

static double next_switch(const struct rb_located *l, double t)
{
	for (int k = l->switch_next; k < l->switch_count; k++)
		if (l->switch_s[k] > t)
			return l->switch_s[k];
	return HUGE_VAL;
}

/* The end of what is known of a body, if it is driven, and that is after `soon`. */
static double driven_end(const struct rb_located *l, int body, double soon)
{
	return body >= 0 && rb_located_driven(l, body) && l->piece[body].until_s > soon
	               ? l->piece[body].until_s
	               : HUGE_VAL;
}

/*
 * Where a driven body that one of the contacts leans on, or that attracts, or what a motor follows,
 * comes to the end of what is known of it.
 */
static double partners_end(const struct rb_modes *w)
{
	const double soon = w->origin_s * (1 + 4 * DBL_EPSILON);
	double end = HUGE_VAL;

	for (int k = 0; k < w->c->held_count; k++) {
		end = fmin(end, driven_end(w->l, w->c->held[k].a, soon));
		end = fmin(end, driven_end(w->l, w->c->held[k].b, soon));
	}
	for (int k = 0; k < w->joints.joint_count; k++) {
		const struct rb_joint *joint = &w->l->model->joints->joint[w->joints.joint[k]];

		end = fmin(end, driven_end(w->l, joint->a, soon));
		end = fmin(end, driven_end(w->l, joint->b, soon));
		end = fmin(end, rb_follow_end(w->l, w->joints.joint[k], soon));
	}
	for (int i = 0; w->l->model->driven && rb_located_gravitates(w->l) && i < w->l->n; i++)
		if (rb_located_driven(w->l, i) && w->l->model->attraction[i] > 0 &&
		    w->l->piece[i].until_s > soon)
			end = fmin(end, w->l->piece[i].until_s);
	return end;
}

/*
 * Time in which the rounding of forces takes bodies that press on each other through the band
 * within which they touch: as long as they would need to fall by their size. Where all else stands
 * still relative to each other, as what gravitation alone holds together, nothing else ends a
 * piece.
 */
static double drifts_within(const struct rb_modes *w)
{
	const struct rb_located *l = w->l;
	double least = HUGE_VAL;

	for (int k = 0; rb_located_gravitates(l) && k < w->c->held_count; k++) {
		const struct rb_contact_point *m = &w->contact_point[k];
		const double acceleration = rb_vec3_length(w->force[k]) *
		                            (l->model->inverse_mass[m->a] +
		                             l->model->inverse_mass[m->b]);

		if (acceleration > 0)
			least = fmin(least, sqrt(rb_contact_point_size(l, m) / acceleration));
	}
	return least;
}

/*
 * Does anything act that the ledger has a cause for? Not where bodies only attract each other, by
 * their masses: that has a potential, and what one gets another one gives.
 */
static bool has_entries(const struct rb_modes *w)
{
	const struct rb_model *model = w->l->model;
	static const rb_features others = RB_FEATURE_GRAVITY | RB_FEATURE_GRAVITY_FORCE |
	                                  RB_FEATURE_FORCES | RB_FEATURE_PUSHES |
	                                  (RB_FEATURES_VARIED &
	                                   ~(rb_features)RB_FEATURE_GRAVITATION);

	return w->c->held_count > 0 || (model->features & others) || !rb_located_gravitates(w->l) ||
	       model->center_count > 0 || !model->attracts_by_mass;
}

/* Are these other forces than those that the resolution has found? */
static bool are_others(const struct rb_modes *w)
{
	double off = 0, max = 0;

	for (int k = 0; k < w->c->held_count; k++) {
		const rb_vec3 n = w->contact_point[k].normal, found = w->c->held[k].force;

		max = fmax(max, rb_vec3_length(found));
		off = fmax(off, fabs(rb_vec3_dot(rb_vec3_sub(w->force[k], found), n)));
	}
	return off > nearly_open * max;
}

/*
 * Forces and accelerations at the beginning. Slips of which no direction is found that forces
 * balance across, or only one with which contacts break the law, do not creep: they turn, however
 * fast that is. And where these are not the forces that the resolution has found, points are one
 * too many but for next to nothing, which would leave the forces to rounding: they keep those, if
 * the modes are as good with them.
 */
static bool begin_modes(struct rb_modes *w)
{
	bool creeps = false;

	const bool joined = rb_modes_join_slips(w);

	if (!rb_rates_evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	if (joined && !w->balanced) {
		rb_modes_part_slips(w);
		if (!rb_rates_evaluate(w, w->origin_s, w->c->piece.start))
			return false;
	}
	w->dense.least = are_others(w) ? nearly_open : 0;
	if (w->dense.least > 0 && !rb_rates_evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	if (w->dense.least > 0 && !(rb_modes_left(w, w->origin_s) <= RB_CHECK_OTHERWISE * w->max)) {
		w->dense.least = 0;
		if (!rb_rates_evaluate(w, w->origin_s, w->c->piece.start))
			return false;
	}
	w->c->least = w->dense.least;
	const bool turn = !w->balanced || rb_check_creeping_breaks_laws(w);
	for (int k = 0; k < w->c->held_count && turn; k++) {
		creeps = creeps || w->c->held[k].creeps;
		w->c->held[k].creeps = false;
	}
	if (creeps && !rb_rates_evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	for (int k = 0; k < w->c->held_count; k++)
		w->slow[k] = w->c->held[k].straight && rb_modes_is_slow(w, k, w->origin_s);
	return true;
}

/* Are joints, constant forces and inertia all that makes the members' pieces short? */
static bool moves_by_joints(const struct rb_modes *w)
{
	struct rb_joint_spring_row spring;

	if (w->joints.count == 0 || w->c->held_count > 0 ||
	    (w->l->model->features & RB_FEATURES_VARIED))
		return false;
	for (int k = 0; k < w->joints.joint_count; k++)
		if (rb_joint_rows_spring(&w->joints, k, w->origin_s, &spring))
			return false;
	return true;
}

/*
 * Joints of which, by rounding, now all and now all but one are independent lock and let go in
 * turn, in pieces that get nowhere (test_located_joints). Counts those; false: there are too many.
 */
static bool count_crept(struct rb_modes *w, double length, double natural_s)
{
	struct rb_cluster *c = w->c;

	if (length < creeping * natural_s)
		c->crept++;
	else if (c->crept > 0)
		c->crept--;
	return c->crept < CREPT_MAX;
}

/* Joints may end the piece before contacts do, of which then none changes its mode. */
static double check_joints_within(struct rb_modes *w, double length, double *value)
{
	const double met = rb_check_stops_within(w, length, value);
	const double within = rb_check_drives_within(w, met, value);

	for (int k = 0; k < w->c->held_count && within < length; k++)
		w->c->held[k].ending = false;
	w->c->hits = w->c->hits && !(within < length);
	return within;
}

/* No step is short enough: an impulse ends the slip, or l->status says why. */
static void fail(struct rb_modes *w, enum rb_status status)
{
	struct rb_located *l = w->l;

	if (status == RB_ERR_PHYSICS && l->status == RB_OK &&
	    ((w->c->held_count > 0 && is_painleve(w)) || rb_failure_by_collision(w) ||
	     rb_failure_by_joints(w, "no step is short enough")))
		return;
	l->status = status;
}

/*
 * The piece, of at most `left_s` seconds, and how long it is good for, s; where l->status says that
 * there is none, or velocities have jumped, nothing.
 */
static double follow(struct rb_modes *w, const struct columns *columns,
                     struct rb_gauss_problem *problem, double left_s)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	double length = 0;

	/* what is straight at the beginning may turn: on what turns itself, say */
	for (bool starts = false, turns = true; turns && l->status == RB_OK;) {
		double try_s = fmin(c->try_s, left_s);
		const double tried = try_s, before = length;
		const bool cut = tried < c->try_s;
		const enum rb_status status = rb_singular_step(
			w, problem, 2 * DBL_EPSILON * w->origin_s, &try_s);

		if (status == RB_ERR_PHYSICS && l->status == RB_OK && !starts &&
		    rb_check_begins_straight(w)) {
			starts = true;
			c->try_s = shorter * (length > 0 ? length : c->try_s);
			continue;
		}
		if (status != RB_OK) {
			fail(w, status);
			break;
		}
		if (w->parts) {
			c->account.n = RB_ENTRIES;
			rb_gauss_integrate(&c->account, c->piece.length_s, w->seen);
		}
		/*
		 * room that was short says nothing of the motion, unless the step was shorter still
		 */
		c->try_s = cut && c->piece.length_s >= tried ? fmax(c->try_s, try_s) : try_s;
		length = c->held_count > 0 ? rb_check_change_within(w, columns->value)
		                           : c->piece.length_s;
		length = rb_singular_keep(w, length, columns->value);
		if (w->joints.joint_count > 0)
			length = check_joints_within(w, length, columns->value);
		c->is_cut = length < c->piece.length_s;
		/* what begins has gone where friction pulls: it was not where forces led */
		if (l->status == RB_OK && !starts && length < creeping * c->piece.length_s &&
		    rb_check_begins_straight(w)) {
			starts = true;
			c->try_s = shorter * (before > 0 ? before : c->piece.length_s);
			continue;
		}
		turns = l->status == RB_OK &&
		        (rb_check_turns_aside(w, length, columns->value) ||
		         rb_check_turns_aside(w, 0.5 * length, columns->value));
		if (turns && starts && rb_check_begins_straight(w))
			c->try_s = shorter * length;
	}
	return length;
}

/* Do forces act that may be stiff, on so few that a matrix of them all is little? */
static bool may_be_stiff(const struct rb_modes *w)
{
	return (w->l->model->features & RB_FEATURES_VARIED &
	        ~(rb_features)RB_FEATURE_GRAVITATION) &&
	       w->c->held_count == 0 && w->joints.joint_count == 0 &&
	       w->c->piece.n <= RB_GAUSS_NEWTON_LIMIT;
}

static void run(struct rb_modes *w, const struct columns *columns)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	uint64_t calls = 0;

	if (!has_entries(w))
		w->parts = NULL;
	struct rb_gauss_problem problem = {
		.n = c->piece.n,
		.rates = rb_rates_of(w),
		.quick_rates = l->top && w->joints.joint_count > 0 ? rb_rates_turning : NULL,
		.noise = l->model->features & RB_FEATURE_FIELD ? rb_modes_noise : NULL,
		.user = w,
		.rate_row = columns->rate_row,
		.guess = guess_of(w, columns->guess),
		.scale = columns->scale,
		.tolerance = tolerance,
		.visited = w->parts ? rb_rates_enter_node : NULL,
		/*
		 * a spring that is passed through pulls the other way at once; a field is the
		 * user's
		 */
		.jumps = (l->model->features & RB_FEATURES_VARIED &
	                  ~(rb_features)(RB_FEATURE_DRAG | RB_FEATURE_GRAVITATION)) != 0,
		.scratch = columns->scratch,
		.newton = may_be_stiff(w)
	                          ? rb_arena_take(l->arena, rb_gauss_newton_size(c->piece.n),
	                                          sizeof(double))
	                          : NULL,
		.products = &l->products,
		.calls = &calls};

	for (int k = 0; k < c->member_count; k++)
		start_rows(w, k, columns->rate_row);
	if (rb_rim_landing_begin(w) || !begin_modes(w) || rb_failure_by_size(w))
		return;
	for (int k = 0; k < c->held_count; k++) {
		c->held[k].force = w->force[k];
		w->force_max = fmax(w->force_max, rb_vec3_length(w->force[k]));
	}
	/*
	 * What has just been said to stick sticks: by so much the solver has not seen it slip. The
	 * next look is where that has grown.
	 */
	for (int k = 0; k < c->held_count; k++)
		w->doubt = fmax(w->doubt,
		                4 * fmin(rb_check_excess(w, k), RB_CHECK_DOUBTFUL * w->force_max));
	const double guess = rb_piece_scales_of(w, columns->scale);
	if (rb_failure_by_lock(w))
		return;
	const double natural_s = moves_by_joints(w) ? fmin(guess, rb_piece_scales_fall(w)) : 0;
	w->calls = &calls;
	w->scale = columns->scale;
	if (!(c->try_s > 0))
		c->try_s = guess;
	/* never past the end of the run by more than it needs, nor over a switch of forces */
	const double left_s = fmin(fmin(fmin(next_switch(l, w->origin_s), partners_end(w)),
	                                w->origin_s + drifts_within(w)),
	                           fmax(l->end_s * (1 + 1e-9), w->origin_s + guess)) -
	                      w->origin_s;
	if (!rb_rates_take_trees(w, c->piece.start, &problem.rate_noise)) {
		if (l->status == RB_OK)
			l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for a cluster");
		return;
	}
	const double length = follow(w, columns, &problem, left_s);

	l->world->frame_counts.body_steps += calls * (uint64_t)c->member_count;
	if (l->status != RB_OK || c->has_jumped)
		return;
	if (length < left_s && !count_crept(w, length, natural_s) &&
	    rb_failure_by_joints(w, "joints lock and let go in turn"))
		return;
	/* a piece ends at a moment that is later than its beginning */
	put_on_piece(w, fmax(w->origin_s + length, nextafter(w->origin_s, HUGE_VAL)));
}

/*
 * What has been given up halfway has left the piece before: its members are where this one was to
 * begin.
 */
static void stay(struct rb_modes *w)
{
	struct rb_gauss_piece *piece = &w->c->piece;

	memset(piece->coefficient, 0, (size_t)piece->n * RB_GAUSS_NODES * sizeof(double));
	piece->length_s = 1;
	put_on_piece(w, w->origin_s);
}

void rb_integrate_piece(struct rb_located *l, int cluster, double t, bool goes_on)
{
	struct rb_modes w = {.l = l,
	                     .c = &l->cluster[cluster],
	                     .origin_s = t,
	                     .row = rb_located_row(l),
	                     .goes_on = goes_on};
	const rb_arena_mark here = rb_arena_here(l->arena);
	struct columns columns;

	RB_ASSERT(cluster >= 0 && cluster < l->cluster_count && l->cluster[cluster].used);
	rb_account_cluster(l, cluster, t);
	w.c->anchor_s = w.c->account_s = t;
	int *kept = NULL;
	if (take_columns(&w, &columns))
		kept = rb_modes_take_places(l, w.c);
	if (!kept) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory to integrate %d bodies",
		                    w.c->member_count);
		return;
	}
	/* rows of the piece that they are on, which is in the same room */
	for (int k = 0; k < w.c->member_count; k++)
		rb_piece_warm_start_keep(l, w.c->member[k], t);
	rb_integrate_lay_out(w.c, w.c->member_count * w.row);
	run(&w, &columns);
	if (l->status != RB_OK)
		stay(&w);
	rb_modes_give_back_places(l, w.c, kept);
	rb_arena_back(l->arena, here);
}

/* Values of a cluster at rest, as those of a piece. */
static void rest_values(const struct rb_modes *w, double t, double *value)
{
	for (int k = 0; k < w->c->member_count; k++) {
		const struct rb_pose pose = rb_arc_pose(w->l, w->c->member[k], t);
		double *const v = value + (size_t)k * (size_t)w->row;

		memset(v, 0, (size_t)w->row * sizeof *v);
		w->base[k] = pose.position;
		if (w->l->top)
			rb_quat_to(v + RB_PIECE_ORIENTATION, pose.orientation);
	}
}

bool rb_integrate_forces(struct rb_located *l, int cluster, double t, rb_vec3 *force)
{
	RB_ASSERT(cluster >= 0 && cluster < l->cluster_count && l->cluster[cluster].used);
	RB_ASSERT(l->cluster[cluster].integrated || l->cluster[cluster].at_rest);
	struct rb_cluster *const c = &l->cluster[cluster];
	struct rb_modes w = {.l = l,
	                     .c = c,
	                     .origin_s = c->integrated ? l->piece[c->member[0]].origin_s : t,
	                     .row = rb_located_row(l)};
	const rb_arena_mark here = rb_arena_here(l->arena);
	/* a look that somebody asks for decides nothing */
	const uint64_t products = l->products;
	const size_t values = (size_t)c->member_count * (size_t)w.row;
	double *const value = rb_arena_take(l->arena, values + (size_t)c->piece.n + 1,
	                                    sizeof *value);
	const int *const kept = value && rb_modes_reserve(&w) ? rb_modes_take_places(l, c) : NULL;
	bool good = kept != NULL;

	if (good) {
		for (int k = 0; c->integrated && k < c->member_count; k++)
			w.base[k] = l->piece[c->member[k]].base;
		w.dense.least = c->least;
		if (c->integrated)
			rb_gauss_values(&c->piece, t - w.origin_s, value);
		else
			rest_values(&w, t, value);
		good = rb_rates_evaluate(&w, t, value);
		memcpy(force, w.force, (size_t)c->held_count * sizeof *force);
		if (good && w.dense.open && !rb_modes_are_lawful(&w) &&
		    rb_check_holds_otherwise(&w, t))
			memcpy(force, w.force, (size_t)c->held_count * sizeof *force);
		if (good && w.joints.count > 0)
			rb_joint_rows_wrenches(&w.joints, w.multiplier, t, l->world->joint_load);
		rb_modes_give_back_places(l, c, kept);
	}
	if (l->status == RB_ERR_PHYSICS) /* too much to look at */
		l->status = RB_OK;
	l->products = products;
	rb_arena_back(l->arena, here);
	return good;
}
