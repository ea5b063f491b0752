/* SPDX-License-Identifier: MIT */
#include "event/integrate.h"

#include <float.h>
#include <string.h>

#include "base/memory.h"
#include "event/mechanics.h"
#include "event/pull.h"

/* Of the sizes of position and velocity, per step; rounding is below it. */
static const double tolerance = 3e-14;
/* Shares of forces by which a mode is seen to have ended, so that what follows does not see it go on. */
static const double clear = 1e-12;
/* Accelerations below this share of the pulls are what the solver leaves. */
static const double still_share = 1e-12;

enum { LOOKS = 8, BISECTIONS = 80, DENSE_MOST = 1536 };

/* One piece under way. */
struct work {
	struct rb_located *l;
	struct rb_cluster *c;
	double origin_s;                  /* of the piece */
	int row;                          /* values a member */
	struct rb_pose *pose;             /* [member_count] */
	rb_vec3 *base;                    /* [member_count]: where positions are counted from */
	rb_vec3 *linear, *angular;        /* [member_count] */
	struct rb_meet *meet;             /* [held_count] */
	struct rb_joint_contact *contact; /* [held_count] */
	rb_vec3 *force;                   /* [held_count]: N on b */
	double *matrix, *right;           /* [unknowns]^2, [unknowns] */
	int *last;                        /* [unknowns] */
	bool slip_ends;                   /* why `broken` said so */
	double force_most;                /* N: largest force at the beginning */
};

static int place_of(const struct work *w, int body)
{
	return body < w->l->n ? w->l->place[body] : -1;
}

/* ---- forces of contacts in given modes ---- */

static int unknowns_of(const struct rb_held *held)
{
	return held->slipping ? 1 : 3;
}

/* Direction of the k-th unknown of a contact: a unit of the normal force with its friction, or an axis. */
static rb_vec3 unit_of(const struct work *w, int contact, int k)
{
	const struct rb_held *held = &w->c->held[contact];
	const struct rb_meet *m = &w->meet[contact];

	if (!held->slipping)
		return (rb_vec3){k == 0, k == 1, k == 2};
	return rb_vec3_add_scaled(m->normal, -w->contact[contact].friction,
	                          w->contact[contact].slip);
}

static rb_vec3 answer(const struct work *w, int body, rb_vec3 arm, rb_vec3 at, rb_vec3 f)
{
	return rb_mechanics_answer(w->l, body, &w->pose[place_of(w, body)], arm, at, f);
}

/* Relative acceleration at contact i by a force `f` on b of contact j. */
static rb_vec3 coupling(const struct work *w, int i, int j, rb_vec3 f)
{
	const struct rb_meet *x = &w->meet[i], *y = &w->meet[j];
	rb_vec3 sum = {0, 0, 0};

	if (place_of(w, y->b) >= 0) {
		if (x->b == y->b)
			sum = rb_vec3_add(sum, answer(w, y->b, y->arm_b, x->arm_b, f));
		if (x->a == y->b)
			sum = rb_vec3_sub(sum, answer(w, y->b, y->arm_b, x->arm_a, f));
	}
	if (place_of(w, y->a) >= 0) {
		if (x->b == y->a)
			sum = rb_vec3_sub(sum, answer(w, y->a, y->arm_a, x->arm_b, f));
		if (x->a == y->a)
			sum = rb_vec3_add(sum, answer(w, y->a, y->arm_a, x->arm_a, f));
	}
	return sum;
}

/*
 * Gaussian elimination with row pivots; false where it is singular. Zeros are passed over, since a contact answers only to
 * those that share a body with it: a chain of contacts costs what its length is.
 */
static bool eliminate(double *matrix, double *right, int *last, int n)
{
	for (int r = 0; r < n; r++)
		for (last[r] = n - 1; last[r] > 0 && matrix[r * n + last[r]] == 0;)
			last[r]--;
	for (int k = 0; k < n; k++) {
		int best = k;
		for (int r = k + 1; r < n; r++)
			if (fabs(matrix[r * n + k]) > fabs(matrix[best * n + k]))
				best = r;
		if (!(fabs(matrix[best * n + k]) > 0))
			return false;
		for (int c = k; c < n && best != k; c++) {
			const double kept = matrix[k * n + c];
			matrix[k * n + c] = matrix[best * n + c];
			matrix[best * n + c] = kept;
		}
		const double kept = right[k];
		right[k] = right[best];
		right[best] = kept;
		const int far = last[k];
		last[k] = last[best];
		last[best] = far;
		for (int r = k + 1; r < n; r++) {
			if (matrix[r * n + k] == 0)
				continue;
			const double share = matrix[r * n + k] / matrix[k * n + k];
			for (int c = k; c <= last[k]; c++)
				matrix[r * n + c] -= share * matrix[k * n + c];
			right[r] -= share * right[k];
			last[r] = last[r] > last[k] ? last[r] : last[k];
		}
	}
	for (int k = n - 1; k >= 0; k--) {
		for (int c = k + 1; c <= last[k]; c++)
			right[k] -= matrix[k * n + c] * right[c];
		right[k] /= matrix[k * n + k];
	}
	return true;
}

static bool share_a_body(const struct rb_meet *x, const struct rb_meet *y)
{
	return x->a == y->a || x->a == y->b || x->b == y->a || x->b == y->b;
}

static rb_vec3 point_acceleration(const struct work *w, int body, rb_vec3 arm, double t)
{
	const int place = place_of(w, body);

	if (place >= 0)
		return rb_vec3_add(w->linear[place], rb_vec3_cross(w->angular[place], arm));
	return rb_vec3_add(rb_arc_acceleration(w->l, body, t),
	                   rb_vec3_cross(rb_mechanics_turning(w->l, body, t), arm));
}

static double axis(rb_vec3 v, int k)
{
	return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/* Fills w->force; false: the modes do not determine them. */
static bool solve_modes(struct work *w, double t)
{
	const struct rb_cluster *c = w->c;
	int n = 0, row = 0;

	for (int k = 0; k < c->held_count; k++)
		n += unknowns_of(&c->held[k]);
	if (n > DENSE_MOST)
		return false;
	for (int i = 0; i < c->held_count; i++) {
		const struct rb_meet *m = &w->meet[i];
		const rb_vec3 free = rb_vec3_add(
			rb_vec3_sub(point_acceleration(w, m->b, m->arm_b, t),
		                    point_acceleration(w, m->a, m->arm_a, t)),
			w->contact[i].bias);
		int column = 0;

		for (int j = 0; j < c->held_count; j++)
			for (int k = 0; k < unknowns_of(&c->held[j]); k++, column++) {
				const rb_vec3 none = {0, 0, 0};
				const rb_vec3 a = share_a_body(m, &w->meet[j])
				                          ? coupling(w, i, j, unit_of(w, j, k))
				                          : none;

				if (c->held[i].slipping)
					w->matrix[row * n + column] = rb_vec3_dot(a, m->normal);
				else
					for (int r = 0; r < 3; r++)
						w->matrix[(row + r) * n + column] = axis(a, r);
			}
		if (c->held[i].slipping)
			w->right[row] = -rb_vec3_dot(free, m->normal);
		else
			for (int r = 0; r < 3; r++)
				w->right[row + r] = -axis(free, r);
		row += unknowns_of(&c->held[i]);
	}
	if (!eliminate(w->matrix, w->right, w->last, n))
		return false;
	row = 0;
	for (int i = 0; i < c->held_count; i++) {
		w->force[i] = (rb_vec3){0, 0, 0};
		for (int k = 0; k < unknowns_of(&c->held[i]); k++)
			w->force[i] = rb_vec3_add_scaled(w->force[i], w->right[row + k],
			                                 unit_of(w, i, k));
		row += unknowns_of(&c->held[i]);
	}
	return true;
}

static int joint_body(const struct work *w, struct rb_joint *joint, int body, double t)
{
	const int place = place_of(w, body);

	if (place >= 0)
		return place;
	joint->body[joint->body_count] = rb_mechanics_fixed(w->l, body, t);
	return joint->body_count++;
}

/* Where modes do not determine the forces (more contacts than freedoms): any that do. */
static bool solve_any(struct work *w, double t)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;
	const rb_arena_mark here = rb_arena_here(l->arena);
	struct rb_joint joint = {.arena = l->arena, .contact_count = c->held_count};

	joint.body = rb_arena_take(l->arena, (size_t)(c->member_count + 2 * c->held_count),
	                           sizeof *joint.body);
	joint.contact = rb_arena_take(l->arena, (size_t)c->held_count, sizeof *joint.contact);
	if (!joint.body || !joint.contact)
		return false;
	joint.body_count = c->member_count;
	for (int k = 0; k < c->member_count; k++)
		joint.body[k] = rb_mechanics_body(l, c->member[k], &w->pose[k], w->linear[k],
		                                  w->angular[k]);
	for (int k = 0; k < c->held_count; k++) {
		joint.contact[k] = w->contact[k];
		joint.contact[k].mode = c->held[k].slipping ? RB_JOINT_SLIDE : RB_JOINT_STICK;
		joint.contact[k].a = joint_body(w, &joint, c->held[k].a, t);
		joint.contact[k].b = joint_body(w, &joint, c->held[k].b, t);
		joint.contact[k].impulse = c->held[k].force;
	}
	rb_joint_forces(&joint);
	for (int k = 0; k < c->held_count; k++)
		w->force[k] = joint.contact[k].impulse;
	rb_arena_back(l->arena, here);
	return true;
}

static void press(struct work *w, int body, rb_vec3 arm, rb_vec3 force)
{
	const int place = place_of(w, body);

	if (place < 0)
		return;
	w->linear[place] = rb_vec3_add_scaled(w->linear[place], w->l->model->inverse_mass[body],
	                                      force);
	if (w->l->top)
		w->angular[place] = rb_vec3_add(
			w->angular[place], rb_pull_yield(w->l, body, w->pose[place].orientation,
		                                         rb_vec3_cross(arm, force)));
}

/* ---- the problem that math/gauss sees ---- */

static void read_pose(struct work *w, int k, const double *value)
{
	const struct rb_located *l = w->l;
	const int i = w->c->member[k];
	const double *v = value + (size_t)k * (size_t)w->row;
	struct rb_pose *pose = &w->pose[k];

	pose->position = rb_vec3_add(w->base[k], rb_vec3_from(v + RB_ROW_POSITION));
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
 * forces that are looked at again and again.
 */
static void stand_still(struct work *w, double pull)
{
	for (int k = 0; k < w->c->member_count; k++) {
		const double radius = rb_model_reach(w->l->model, w->c->member[k]);

		if (rb_vec3_max_abs(w->pose[k].velocity) > 0 ||
		    rb_vec3_max_abs(w->pose[k].spin) > 0 ||
		    rb_vec3_max_abs(w->linear[k]) > still_share * pull ||
		    rb_vec3_max_abs(w->angular[k]) * radius > still_share * pull)
			return;
	}
	for (int k = 0; k < w->c->member_count; k++)
		w->linear[k] = w->angular[k] = (rb_vec3){0, 0, 0};
}

/* Poses, forces of contacts and accelerations at `t`. */
static bool evaluate(struct work *w, double t, const double *value)
{
	struct rb_located *l = w->l;
	const struct rb_cluster *c = w->c;
	const struct rb_view view = {.pose = w->pose, .time_s = t, .active_s = w->origin_s};
	double pull = 0;

	for (int k = 0; k < c->member_count; k++)
		read_pose(w, k, value);
	for (int k = 0; k < c->member_count; k++)
		rb_pull_at(l, c->member[k], &w->pose[k], &view, &w->linear[k], &w->angular[k]);
	if (l->status != RB_OK)
		return false;
	for (int k = 0; k < c->member_count; k++)
		pull = fmax(pull, rb_vec3_max_abs(w->linear[k]));
	for (int k = 0; k < c->held_count; k++) {
		const struct rb_held *held = &c->held[k];
		const int a = place_of(w, held->a), b = place_of(w, held->b);
		const struct rb_pose pose_a = a >= 0 ? w->pose[a] : rb_arc_pose(l, held->a, t);
		const struct rb_pose pose_b = b >= 0 ? w->pose[b] : rb_arc_pose(l, held->b, t);

		w->meet[k] = rb_meet_poses(l, held->a, held->b, &pose_a, &pose_b);
		w->contact[k] = rb_mechanics_contact(l, &w->meet[k]);
		/* a direction that is kept turns with the normal all the same */
		w->contact[k].slip = rb_vec3_unit(rb_vec3_reject(held->slip, w->meet[k].normal),
		                                  held->slip);
		if (held->slipping && !held->straight) {
			const rb_vec3 slip = rb_vec3_reject(w->meet[k].velocity, w->meet[k].normal);
			const double speed = rb_vec3_length(slip);

			if (speed > 0)
				w->contact[k].slip = rb_vec3_scale(1 / speed, slip);
		}
	}
	if (c->held_count > 0 && !solve_modes(w, t) && !solve_any(w, t))
		return false;
	for (int k = 0; k < c->held_count; k++) {
		press(w, c->held[k].a, w->meet[k].arm_a, rb_vec3_neg(w->force[k]));
		press(w, c->held[k].b, w->meet[k].arm_b, w->force[k]);
	}
	if (c->held_count > 0)
		stand_still(w, pull);
	return true;
}

static enum rb_status rates(void *user, double t, const double *value, double *rate,
                            struct rb_error *err)
{
	struct work *w = user;

	if (!evaluate(w, t, value))
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
		const rb_quat turn = {0, 0.5 * w->pose[k].spin.x, 0.5 * w->pose[k].spin.y,
		                      0.5 * w->pose[k].spin.z};
		rb_quat_to(r + RB_ROW_ORIENTATION,
		           rb_quat_multiply(turn, rb_quat_from(v + RB_ROW_ORIENTATION)));
		rb_vec3_to(r + RB_ROW_SPIN, w->angular[k]);
	}
	return RB_OK;
}

/* ---- changes of mode ---- */

/* The first contact that does not keep its mode at this state, -1: all do. */
static int broken(struct work *w)
{
	const struct rb_cluster *c = w->c;

	for (int k = 0; k < c->held_count; k++) {
		const struct rb_held *held = &c->held[k];
		const struct rb_meet *m = &w->meet[k];
		const double normal = rb_vec3_dot(w->force[k], m->normal);
		const rb_vec3 friction = rb_vec3_add_scaled(w->force[k], -normal, m->normal);

		w->slip_ends = false;
		if (normal < -clear * w->force_most)
			return k;
		if (m->on_rim != held->on_rim)
			return k;
		if (!held->slipping && rb_vec3_length(friction) > w->contact[k].friction * normal +
		                                                          clear * w->force_most)
			return k;
		w->slip_ends = held->slipping && held->straight &&
		               rb_vec3_dot(m->velocity, w->contact[k].slip) < 0;
		if (w->slip_ends)
			return k;
	}
	return -1;
}

static int broken_at(struct work *w, double s, double *value)
{
	rb_gauss_values(&w->c->piece, s, value);
	return evaluate(w, w->origin_s + s, value) ? broken(w) : -1;
}

/* Where in the piece a mode ends first, seconds; the whole length if none does. */
static double change_within(struct work *w, double *value)
{
	const double length = w->c->piece.length_s;
	double good = 0, bad = length;
	int which = -1;

	for (int k = 1; k <= LOOKS && which < 0; k++) {
		bad = k < LOOKS ? length * k / LOOKS : length;
		which = broken_at(w, bad, value);
		if (which < 0)
			good = bad;
	}
	if (which < 0 || w->l->status != RB_OK)
		return length;
	bool ends = w->slip_ends;
	for (int round = 0; round < BISECTIONS && bad - good > 0; round++) {
		const double middle = good + 0.5 * (bad - good);

		if (middle <= good || middle >= bad)
			break;
		const int now = broken_at(w, middle, value);
		if (now >= 0) {
			bad = middle;
			which = now;
			ends = w->slip_ends;
		} else {
			good = middle;
		}
	}
	w->c->held[which].ending = ends;
	return bad;
}

/* ---- a piece ---- */

static bool room(struct work *w, int n, double **value, double **scale, double **scratch)
{
	struct rb_cluster *c = w->c;
	const size_t size = (size_t)n * (3 + RB_GAUSS_NODES) + rb_gauss_room(n);
	struct rb_arena *arena = w->l->arena;
	size_t unknowns = 0;

	for (int k = 0; k < c->held_count; k++)
		unknowns += (size_t)unknowns_of(&c->held[k]);
	if (unknowns > DENSE_MOST)
		unknowns = 0;
	if (!rb_memory_reserve(&c->block, &c->block_capacity, size, sizeof *c->block))
		return false;
	c->piece = (struct rb_gauss_piece){.n = n, .start = c->block, .coefficient = c->block + n};
	*scale = c->block + (size_t)n * (1 + RB_GAUSS_NODES);
	*value = *scale + n;
	*scratch = *value + n;
	w->pose = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->pose);
	w->base = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->base);
	w->linear = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->linear);
	w->angular = rb_arena_take(arena, (size_t)c->member_count, sizeof *w->angular);
	w->meet = rb_arena_take(arena, (size_t)c->held_count + 1, sizeof *w->meet);
	w->contact = rb_arena_take(arena, (size_t)c->held_count + 1, sizeof *w->contact);
	w->force = rb_arena_take(arena, (size_t)c->held_count + 1, sizeof *w->force);
	w->matrix = rb_arena_take(arena, unknowns * unknowns + 1, sizeof *w->matrix);
	w->right = rb_arena_take(arena, unknowns + 1, sizeof *w->right);
	w->last = rb_arena_take(arena, unknowns + 1, sizeof *w->last);
	return w->pose && w->base && w->linear && w->angular && w->meet && w->contact && w->force &&
	       w->matrix && w->right && w->last;
}

/* Sizes that errors are relative to, and what length to try without knowing better. */
static double sizes(struct work *w, double *scale)
{
	const struct rb_located *l = w->l;
	double try_s = l->end_s;

	for (int k = 0; k < w->c->member_count; k++) {
		const struct rb_pose *pose = &w->pose[k];
		const double radius = rb_model_reach(l->model, w->c->member[k]);
		const double pull = rb_vec3_length(w->linear[k]);
		const double speed = fmax(rb_vec3_length(pose->velocity), sqrt(pull * radius));
		const double spin = fmax(rb_vec3_length(pose->spin), speed / radius);
		double *const s = scale + (size_t)k * (size_t)w->row;

		for (int m = 0; m < 3; m++) {
			/* of a long way, its rounding */
			s[RB_ROW_POSITION + m] = fmax(radius, speed * w->c->try_s / 32);
			s[RB_ROW_VELOCITY + m] = speed > 0 ? speed : radius / l->end_s;
		}
		for (int m = RB_ROW_ORIENTATION; l->top && m < RB_ROW_SPIN; m++)
			s[m] = 1;
		for (int m = 0; l->top && m < 3; m++)
			s[RB_ROW_SPIN + m] = spin > 0 ? spin : 1 / l->end_s;
		if (speed > 0)
			try_s = fmin(try_s, radius / speed);
	}
	return try_s;
}

static void put_on_piece(struct work *w, double until_s)
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
static double partners_end(const struct work *w)
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

static void run(struct work *w, double *value, double *scale, double *scratch)
{
	struct rb_located *l = w->l;
	struct rb_cluster *c = w->c;
	uint64_t calls = 0;
	struct rb_gauss_problem problem = {.n = c->piece.n,
	                                   .rates = rates,
	                                   .user = w,
	                                   .scale = scale,
	                                   .tolerance = tolerance,
	                                   .scratch = scratch,
	                                   .calls = &calls};

	for (int k = 0; k < c->member_count; k++) {
		const struct rb_pose pose = rb_arc_pose(l, c->member[k], w->origin_s);
		double *const v = c->piece.start + (size_t)k * (size_t)w->row;

		w->base[k] = pose.position;
		rb_vec3_to(v + RB_ROW_POSITION, (rb_vec3){0, 0, 0});
		rb_vec3_to(v + RB_ROW_VELOCITY, pose.velocity);
		if (!l->top)
			continue;
		rb_quat_to(v + RB_ROW_ORIENTATION, pose.orientation);
		rb_vec3_to(v + RB_ROW_SPIN, pose.spin);
	}
	if (!evaluate(w, w->origin_s, c->piece.start))
		return;
	for (int k = 0; k < c->held_count; k++) {
		c->held[k].force = w->force[k];
		w->force_most = fmax(w->force_most, rb_vec3_length(w->force[k]));
	}
	const double guess = sizes(w, scale);
	if (!(c->try_s > 0))
		c->try_s = guess;
	/* never past the end of the run by more than it needs, nor over a switch of forces */
	const double room_s = fmin(fmin(next_switch(l, w->origin_s), partners_end(w)),
	                           fmax(l->end_s * (1 + 1e-9), w->origin_s + guess)) -
	                      w->origin_s;
	double try_s = fmin(c->try_s, room_s);
	const bool cut = try_s < c->try_s;
	const enum rb_status status = rb_gauss_step(
		&problem, w->origin_s, &try_s, 2 * DBL_EPSILON * w->origin_s, &c->piece, l->err);
	l->world->frame_counts.body_steps += calls * (uint64_t)c->member_count;
	if (status != RB_OK) {
		l->status = status;
		return;
	}
	c->try_s = cut ? fmax(c->try_s, try_s) : try_s;
	const double length = c->held_count > 0 ? change_within(w, value) : c->piece.length_s;
	c->is_cut = length < c->piece.length_s;
	if (l->status != RB_OK)
		return;
	/* a piece ends at a moment that is later than its beginning */
	put_on_piece(w, fmax(w->origin_s + length, nextafter(w->origin_s, HUGE_VAL)));
}

void rb_integrate_piece(struct rb_located *l, int cluster, double t)
{
	struct work w = {
		.l = l, .c = &l->cluster[cluster], .origin_s = t, .row = rb_located_row(l)};
	const rb_arena_mark here = rb_arena_here(l->arena);
	const int count = w.c->member_count;
	double *value, *scale, *scratch;
	int *const kept = rb_arena_take(l->arena, (size_t)count, sizeof *kept);

	if (!l->piece)
		l->piece = rb_memory_take((size_t)l->n, sizeof *l->piece);
	if (!kept || !l->piece || !room(&w, count * w.row, &value, &scale, &scratch)) {
		l->status = RB_FAIL(l->err, RB_ERR_MEMORY, "no memory to integrate %d bodies",
		                    count);
		return;
	}
	/* within the piece, places are those of the members */
	for (int k = 0; k < count; k++) {
		kept[k] = l->place[w.c->member[k]];
		l->place[w.c->member[k]] = k;
	}
	run(&w, value, scale, scratch);
	for (int k = 0; k < count; k++)
		l->place[w.c->member[k]] = kept[k];
	rb_arena_back(l->arena, here);
}
