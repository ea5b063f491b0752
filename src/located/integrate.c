/* SPDX-License-Identifier: MIT */
#include "located/integrate.h"

#include "base/error.h"

#include <float.h>
#include <string.h>

#include "base/memory.h"
#include "located/account.h"
#include "located/event_records.h"
#include "located/failure.h"
#include "located/field_samples.h"
#include "located/follow.h"
#include "located/rim_landing.h"
#include "located/mode_checks.h"
#include "located/piece_warm_start.h"
#include "located/painleve.h"
#include "located/rates.h"
#include "located/event_set.h"
#include "located/other_forces.h"
#include "located/singular.h"
#include "located/piece_scales.h"
#include "located/work.h"
#include "located/mechanics.h"
#include "math/gauss_newton.h"

/* Error per step, relative to the sizes of position and velocity; rounding is below it. */
static const double tolerance = 3e-14;
/*
 * Share of a column that must be independent of the others, where a smaller one leads to forces
 * that differ from those of the resolution.
 */
static const double nearly_open = 1e-6;
/*
 * Pieces shorter than this share of the time in which loads would move a member by its size creep:
 * pieces of joined bodies are within 2^-8 of that time. CREPT_MAX: how many more creeping pieces
 * than others are too many; CREPT_LOCKED: if the joints' rows contradict each other.
 */
static const double creeping = 0x1p-20;
/* Factor for the length of a piece in which a slip turns: its deviation falls with the square. */
static const double shorter_share = 0.25;
enum { CREPT_MAX = 256, CREPT_LOCKED = 4 };

/* Arrays for the next piece. */
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
	/* where the scratch of steps was: the last one has been taken */
	c->at_nodes = c->block + rb_integrate_kept_size(n) + (size_t)n * (2 + RB_GAUSS_NODES);
	c->has_nodes = false;
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
 * Guess of the rates, from the piece on which all members have been until this moment. If a mode or
 * an impact has ended it, the jump is seen at the beginning (math/gauss).
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
 * Lets the cluster's single pair rebound by the law of eccentric impacts, with all its points as
 * one, as when a slip begins that no force allows (located/tangential_impact): its slip may turn
 * instead of stopping. False: there are several pairs, or a force allows the slip.
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
 * Painleve impulse: afterwards all contacts stick, or one slips more slowly, and the cluster must
 * be resolved anew. False: not such a case.
 */
static bool apply_painleve(struct rb_modes *w)
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
	/* its impulses ignore joints: where friction jams a mechanism, the piece fails */
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
		/* painleve.scratch: changes of velocity by the impulses */
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

/* End of the known motion of a driven body, if it is later than `after_s`. */
static double driven_end(const struct rb_located *l, int body, double after_s)
{
	return body >= 0 && rb_located_driven(l, body) && l->piece[body].until_s > after_s
	               ? l->piece[body].until_s
	               : HUGE_VAL;
}

/* The first of these ends among the driven bodies on springs of a body. */
static double spring_partners_end(const struct rb_located *l, int body, double after_s)
{
	double end = HUGE_VAL;

	for (int k = 0; k < l->model->element_list_count; k++) {
		const struct rb_elements *elements = &l->model->elements[k];

		for (int m = elements->end ? elements->first[body] : 0;
		     elements->end && m < elements->first[body + 1]; m++)
			for (int e = 0; e < 2; e++)
				end = fmin(end, driven_end(l, elements->end[elements->of[m]][e],
				                           after_s));
	}
	return end;
}

/*
 * The first end of the known motion of a driven body that a contact, joint or spring involves, or
 * that attracts, or of what a motor follows.
 */
static double partners_end(const struct rb_modes *w)
{
	const double after_s = w->origin_s * (1 + 4 * DBL_EPSILON);
	double end = HUGE_VAL;

	for (int k = 0; k < w->c->held_count; k++) {
		end = fmin(end, driven_end(w->l, w->c->held[k].a, after_s));
		end = fmin(end, driven_end(w->l, w->c->held[k].b, after_s));
	}
	for (int k = 0; k < w->joints.joint_count; k++) {
		const struct rb_joint *joint = &w->l->model->joints->joint[w->joints.joint[k]];

		end = fmin(end, driven_end(w->l, joint->a, after_s));
		end = fmin(end, driven_end(w->l, joint->b, after_s));
		end = fmin(end, rb_follow_end(w->l, w->joints.joint[k], after_s));
	}
	for (int k = 0; w->l->model->driven && k < w->c->member_count; k++)
		end = fmin(end, spring_partners_end(w->l, w->c->member[k], after_s));
	for (int i = 0; w->l->model->driven && rb_located_gravitates(w->l) && i < w->l->n; i++)
		if (rb_located_driven(w->l, i) && w->l->model->attraction[i] > 0 &&
		    w->l->piece[i].until_s > after_s)
			end = fmin(end, w->l->piece[i].until_s);
	return end;
}

/*
 * Time in which rounding of forces moves bodies that press on each other through their touching
 * range: the time of a fall by their size. If all of them are at rest relative to each other, as
 * bodies held together by gravitation alone, nothing else ends a piece.
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
 * Does anything act that has a cause in the ledger? Not if bodies only attract each other, by their
 * masses: that has a potential, and momentum is exchanged between them.
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

/* Do these forces differ from those that the resolution found? */
static bool differ_from_resolution(const struct rb_modes *w)
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
 * Forces and accelerations at the beginning. Slips do not creep if no direction is found that
 * balances the tangential forces, or only one with which contacts violate the law: they turn,
 * however fast. If the forces differ from those of the resolution, there is one point too many but
 * for a nearly dependent column, which would leave the forces to rounding: then the near dependence
 * is taken as exact, if the modes are satisfied as well.
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
	w->dense.least = differ_from_resolution(w) ? nearly_open : 0;
	if (w->dense.least > 0 && !rb_rates_evaluate(w, w->origin_s, w->c->piece.start))
		return false;
	if (w->dense.least > 0 &&
	    !(rb_modes_residual(w, w->origin_s) <= RB_OTHER_FORCES_SAME * w->max)) {
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
 * Joints of which, by rounding, alternately all or all but one are independent lock and unlock in
 * turn, in pieces that make no progress (test_located_joints). Counts such pieces; false: there are
 * too many.
 */
static bool count_crept(struct rb_modes *w, double length, double natural_s)
{
	struct rb_cluster *c = w->c;

	if (length < creeping * natural_s)
		c->crept++;
	else if (c->crept > 0)
		c->crept--;
	return c->crept < CREPT_MAX &&
	       (c->crept % CREPT_LOCKED != 0 || c->crept == 0 ||
	        !rb_other_forces_contradict(w, w->origin_s, c->piece.start));
}

/* Joints may end the piece before contacts do; then no contact changes its mode. */
static double limit_by_joints(struct rb_modes *w, double length, double *value)
{
	const double stop_length = rb_check_stops_within(w, length, value);
	const double within = rb_check_drives_within(w, stop_length, value);

	for (int k = 0; k < w->c->held_count && within < length; k++)
		w->c->held[k].ending = false;
	w->c->hits = w->c->hits && !(within < length);
	return within;
}

/* No step is short enough: an impulse ends the slip, or l->status gives the reason. */
static void fail(struct rb_modes *w, enum rb_status status)
{
	struct rb_located *l = w->l;

	if (status == RB_ERR_PHYSICS && l->status == RB_OK &&
	    ((w->c->held_count > 0 && apply_painleve(w)) || rb_failure_by_collision(w) ||
	     rb_failure_by_joints(w, "no step is short enough")))
		return;
	l->status = status;
}

/*
 * Does the field, at the first sample, depart from the step's nodes? Then the step is to end there;
 * later samples are looked at when their time has come.
 */
static bool misses_field(struct rb_modes *w)
{
	const struct rb_field_samples of = {w->l, w->c, w->origin_s, w->base};
	const double sample_s = rb_field_samples_after(w->l, w->origin_s);

	w->c->has_nodes = false;
	if (!rb_field_samples_depart(&of, sample_s))
		return false;
	w->c->try_s = sample_s - w->origin_s;
	return true;
}

/*
 * Steps over a moment at which the field jumps, where the step before has ended: rounding of time,
 * `*try_s`, is all that can be wrong. The next piece starts afresh. Otherwise `status`.
 */
static enum rb_status step_over_jump(struct rb_modes *w, const struct rb_gauss_problem *problem,
                                     enum rb_status status, double *try_s)
{
	const struct rb_field_samples of = {w->l, w->c, w->origin_s, w->base};
	struct rb_gauss_problem coarse = *problem;

	if (status != RB_ERR_PHYSICS || w->l->status != RB_OK ||
	    !rb_field_samples_jump(&of, *try_s))
		return status;
	coarse.tolerance = 1;
	status = rb_gauss_step(&coarse, w->origin_s, try_s, *try_s, &w->c->piece, w->l->err);
	*try_s = 0;
	return status;
}

/*
 * Integrates a piece of at most `left_s` seconds; returns the time for which it is valid, s.
 * Nothing, if l->status is an error or velocities have jumped.
 */
static double follow(struct rb_modes *w, const struct columns *columns,
                     struct rb_gauss_problem *problem, double max_s)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	double length = 0;

	/* slips that begin straight may turn, for instance on a rotating body */
	for (bool starts = false, turns = true; turns && l->status == RB_OK;) {
		double try_s = fmin(c->try_s, max_s);
		const double requested_s = try_s, before = length;
		const bool cut = requested_s < c->try_s;
		const double least_s = 2 * DBL_EPSILON * w->origin_s;
		enum rb_status status = rb_singular_step(w, problem, least_s, &try_s);

		if (status == RB_ERR_PHYSICS && l->status == RB_OK && !starts &&
		    rb_check_begins_straight(w)) {
			starts = true;
			c->try_s = shorter_share * (length > 0 ? length : c->try_s);
			continue;
		}
		if (status != RB_OK) {
			try_s = 2 * least_s;
			status = step_over_jump(w, problem, status, &try_s);
		}
		if (status != RB_OK) {
			fail(w, status);
			break;
		}
		if (misses_field(w))
			continue;
		if (w->parts) {
			c->account.n = RB_ENTRIES;
			rb_gauss_integrate(&c->account, c->piece.length_s, w->node_entries);
		}
		/*
		 * a limited step says nothing of the motion, unless the accepted one was shorter
		 * still
		 */
		c->try_s = cut && c->piece.length_s >= requested_s ? fmax(c->try_s, try_s) : try_s;
		length = c->held_count > 0 ? rb_check_change_within(w, columns->value)
		                           : c->piece.length_s;
		length = rb_singular_keep(w, length, columns->value);
		if (w->joints.joint_count > 0)
			length = limit_by_joints(w, length, columns->value);
		c->is_cut = length < c->piece.length_s;
		/*
		 * a slip that begins went in the direction of its friction: it was not in that of
		 * the forces
		 */
		if (l->status == RB_OK && !starts && length < creeping * c->piece.length_s &&
		    rb_check_begins_straight(w)) {
			starts = true;
			c->try_s = shorter_share * (before > 0 ? before : c->piece.length_s);
			continue;
		}
		turns = l->status == RB_OK &&
		        (rb_check_turns_aside(w, length, columns->value) ||
		         rb_check_turns_aside(w, 0.5 * length, columns->value));
		if (turns && starts && rb_check_begins_straight(w))
			c->try_s = shorter_share * length;
	}
	return length;
}

/* Do forces act that may be stiff, on so few bodies that a matrix of all of them is small? */
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
		.noise = l->model->features & RB_FEATURE_FIELD ? rb_rates_noise : NULL,
		.user = w,
		.rate_row = columns->rate_row,
		.guess = guess_of(w, columns->guess),
		.scale = columns->scale,
		.tolerance = tolerance,
		.visited = w->parts ? rb_rates_enter_node : NULL,
		/* the force of a spring of length zero reverses at once; a field is the user's */
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
	 * A contact that was just found to stick sticks: the excess of its friction is the solver's
	 * error, and is checked again only when it has grown.
	 */
	for (int k = 0; k < c->held_count; k++)
		w->uncertainty = fmax(w->uncertainty, 4 * fmin(rb_check_excess(w, k),
		                                               RB_CHECK_DOUBTFUL * w->force_max));
	const double guess = rb_piece_scales_of(w, columns->scale);
	if (rb_failure_by_lock(w))
		return;
	const double natural_s = moves_by_joints(w) ? fmin(guess, rb_piece_scales_fall(w)) : 0;
	w->calls = &calls;
	w->scale = columns->scale;
	if (!(c->try_s > 0))
		c->try_s = guess;
	/* not past the end of the run by more than one piece, nor across a switch of forces */
	const double max_s = fmin(fmin(fmin(next_switch(l, w->origin_s), partners_end(w)),
	                               w->origin_s + drifts_within(w)),
	                          fmax(l->end_s * (1 + 1e-9), w->origin_s + guess)) -
	                     w->origin_s;
	if (!rb_rates_take_trees(w, c->piece.start, &problem.rate_noise)) {
		if (l->status == RB_OK)
			l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory for a cluster");
		return;
	}
	const double length = follow(w, columns, &problem, max_s);

	l->world->frame_counts.body_steps += calls * (uint64_t)c->member_count;
	if (l->status != RB_OK || c->has_jumped)
		return;
	if (length < max_s && !count_crept(w, length, natural_s) &&
	    rb_failure_by_joints(w, "joints lock and let go in turn"))
		return;
	/* a piece must end later than it begins */
	put_on_piece(w, fmax(w->origin_s + length, nextafter(w->origin_s, HUGE_VAL)));
}

/*
 * Puts the members of a failed piece on a constant one, where it was to begin: the previous piece
 * has been overwritten.
 */
static void stop_at_start(struct rb_modes *w)
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
	/* saves the rows of their present piece, which uses the same storage */
	for (int k = 0; k < w.c->member_count; k++)
		rb_piece_warm_start_keep(l, w.c->member[k], t);
	rb_integrate_lay_out(w.c, w.c->member_count * w.row);
	run(&w, &columns);
	if (l->status != RB_OK)
		stop_at_start(&w);
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
	/* a query must not change decisions */
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
		if (good && w.dense.open && !rb_modes_are_lawful(&w) && rb_other_forces_hold(&w, t))
			memcpy(force, w.force, (size_t)c->held_count * sizeof *force);
		if (good && w.joints.count > 0)
			rb_joint_rows_wrenches(&w.joints, w.multiplier, t, l->world->joint_load);
		rb_modes_give_back_places(l, c, kept);
	}
	if (l->status == RB_ERR_PHYSICS) /* too much for a query */
		l->status = RB_OK;
	l->products = products;
	rb_arena_back(l->arena, here);
	return good;
}
