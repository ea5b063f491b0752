/* SPDX-License-Identifier: MIT */
/*
 * Evaluates arcs. An arc is a parabola from an anchor, or its counterpart with linear drag, with a
 * closed-form or series rotation (math/top); a piece is the dense output of the integrator
 * (math/gauss), read three rows at a time. Positions on pieces are relative to a base, and `rest`
 * carries the rounding remainder of the sum, so that a chain of pieces loses no digits.
 */
#include "located/arc.h"

#include "base/error.h"
#include "located/account.h"
#include "located/piece_warm_start.h"
#include "math/turn.h"
#include "model/center.h"

#include <stddef.h>

_Static_assert(offsetof(struct rb_arc, acceleration) == 64, "the rest is one line of memory");

rb_vec3 rb_arc_piece_vector(const struct rb_piece_of *p, int row, double t)
{
	double v[3];

	RB_ASSERT_COSTLY(p->piece.n > 0);
	RB_ASSERT_COSTLY(row >= 0 && row + 3 <= p->piece.n - p->first);
	rb_gauss_some(&p->piece, p->first + row, 3, t - p->origin_s, v);
	return rb_vec3_from(v);
}

rb_vec3 rb_arc_piece_rate(const struct rb_piece_of *p, int row, double t)
{
	double v[3];

	RB_ASSERT_COSTLY(p->piece.n > 0);
	RB_ASSERT_COSTLY(row >= 0 && row + 3 <= p->piece.n - p->first);
	rb_gauss_some_rates(&p->piece, p->first + row, 3, t - p->origin_s, v);
	return rb_vec3_from(v);
}

rb_vec3 rb_arc_piece_position(const struct rb_piece_of *p, double t)
{
	return rb_vec3_add(p->base, rb_arc_piece_vector(p, RB_PIECE_POSITION, t));
}

/* Acceleration at the anchor, which decays as e^-z. */
static rb_vec3 first_acceleration(const struct rb_arc *arc)
{
	return rb_vec3_add_scaled(arc->acceleration, -arc->decay, arc->velocity);
}

double rb_arc_acceleration_max(const struct rb_located *l, int i)
{
	if (i >= l->n)
		return 0;
	if (rb_located_on_piece(l, i))
		return l->piece[i].acceleration_max;
	return rb_vec3_length(l->arc[i].decay > 0 ? first_acceleration(&l->arc[i])
	                                          : l->arc[i].acceleration);
}

rb_vec3 rb_arc_acceleration(const struct rb_located *l, int i, double t)
{
	if (i >= l->n)
		return (rb_vec3){0, 0, 0};
	if (rb_arc_decay(l, i) > 0) {
		const struct rb_arc *const arc = &l->arc[i];
		const double z = arc->decay * (t - arc->anchor_s);

		return rb_vec3_scale(rb_decay_at(z).left, first_acceleration(arc));
	}
	if (!rb_located_on_piece(l, i))
		return l->arc[i].acceleration;
	return rb_arc_piece_rate(&l->piece[i], RB_PIECE_VELOCITY, t);
}

/*
 * Sets orientation and spin at t: by the piece's polynomial, by exact integration of the spin if
 * nothing depends on the orientation (math/turn), or by the top.
 */
static void set_rotation(const struct rb_located *l, int i, double t, struct rb_pose *pose)
{
	if (rb_located_on_piece(l, i)) {
		const struct rb_piece_of *p = &l->piece[i];
		const double *const begin = p->piece.start + p->first + RB_PIECE_ORIENTATION;
		double q[4];

		pose->spin = rb_arc_piece_vector(p, RB_PIECE_SPIN, t);
		if (l->orientation_unused[i]) {
			pose->orientation = rb_turn_through(&p->piece, p->first + RB_PIECE_SPIN,
			                                    rb_quat_from(begin), t - p->origin_s);
			return;
		}
		rb_gauss_some(&p->piece, p->first + RB_PIECE_ORIENTATION, 4, t - p->origin_s, q);
		pose->orientation = rb_quat_unit(rb_quat_from(q));
		return;
	}
	rb_top_at(&l->top[i], t - l->arc[i].anchor_s, &pose->orientation, &pose->spin);
}

/* Sets position, its rounding remainder, and velocity of a body on a piece. */
static void set_translation(const struct rb_piece_of *p, double t, struct rb_pose *pose)
{
	double v[RB_PIECE_ORIENTATION];

	rb_gauss_some(&p->piece, p->first, RB_PIECE_ORIENTATION, t - p->origin_s, v);
	const rb_vec3 way = rb_vec3_from(v + RB_PIECE_POSITION);
	pose->position = rb_vec3_add(p->base, way);
	pose->rest = rb_vec3_lost(p->base, way, pose->position);
	pose->velocity = rb_vec3_from(v + RB_PIECE_VELOCITY);
}

struct rb_pose rb_arc_pose(const struct rb_located *l, int i, double t)
{
	struct rb_pose pose = {.position = {0, 0, 0}};

	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	RB_ASSERT_COSTLY(!isnan(t));
	if (rb_located_on_piece(l, i)) {
		set_translation(&l->piece[i], t, &pose);
	} else {
		pose.position = rb_arc_position(l, i, t);
		pose.velocity = rb_arc_velocity(l, i, t);
		if (l->piece && i < l->n)
			pose.rest = l->piece[i].rest;
	}
	if (i < l->n && l->top)
		set_rotation(l, i, t, &pose);
	else
		pose.orientation = l->model->orientation[i];
	pose.origin = pose.position;
	if (i < l->n)
		pose.origin = rb_model_origin(l->model, i, pose.position, pose.orientation);
	return pose;
}

void rb_arc_displace(const struct rb_located *l, int i, struct rb_pose *pose, rb_vec3 way,
                     rb_vec3 turn)
{
	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	rb_arc_move(pose, way);
	if (l->top && rb_vec3_max_abs(turn) > 0)
		pose->orientation = rb_quat_turned(pose->orientation, turn);
	pose->origin = rb_model_origin(l->model, i, pose->position, pose->orientation);
}

rb_vec3 rb_arc_off_center(const struct rb_located *l, int i, double t)
{
	RB_ASSERT_COSTLY(rb_located_is_body(l, i));
	return rb_arc_pose(l, i, t).origin;
}

void rb_arc_anchor(struct rb_located *l, int i, double t, const struct rb_pose *pose,
                   rb_vec3 acceleration, rb_vec3 turning)
{
	RB_ASSERT_COSTLY(rb_located_moves(l, i));

	const rb_vec3 gravity = l->model->scene->world.gravity;
	const struct rb_shape *shape = &l->model->shape[i];
	/* spheres under gravity alone, as the fast paths of located/predict assume */
	const bool plain = shape->kind == RB_SHAPE_SPHERE && !l->model->center_of_mass &&
	                   acceleration.x == gravity.x && acceleration.y == gravity.y &&
	                   acceleration.z == gravity.z;

	rb_account_arc(l, i, t);
	l->arc[i] = (struct rb_arc){.anchor_s = t,
	                            .position = pose->position,
	                            .velocity = pose->velocity,
	                            .plain_radius = plain ? shape->radius : (double)NAN,
	                            .acceleration = acceleration};
	if (l->piece) {
		rb_piece_warm_start_keep(l, i, t);
		l->piece[i].piece.n = 0;
		l->piece[i].rest = pose->rest;
	}
	if (l->top)
		l->top[i] = rb_top_start(&l->top_body[i], pose->orientation, pose->spin, turning);
}

void rb_arc_set_drag(struct rb_located *l, int i, double decay)
{
	RB_ASSERT_COSTLY(rb_located_moves(l, i) && !rb_located_on_piece(l, i));
	RB_ASSERT_COSTLY(decay == 0 || (decay > 0 && l->decays));
	l->arc[i].decay = decay;
}

/* Not inlined, so that storing bodies without rotation needs no pose on the stack. */
__attribute__((noinline)) static void store_turned(const struct rb_located *l, int i, double t)
{
	struct rb_state *state = &l->world->state;
	struct rb_pose pose;

	set_rotation(l, i, t, &pose);
	rb_quat_to(state->orientation + 4 * (size_t)i, pose.orientation);
	rb_vec3_to(state->spin + 3 * (size_t)i, pose.spin);
}

void rb_arc_store(const struct rb_located *l, int i, double t)
{
	struct rb_state *state = &l->world->state;

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	rb_vec3_to(state->position + 3 * (size_t)i, rb_arc_position(l, i, t));
	rb_vec3_to(state->velocity + 3 * (size_t)i, rb_arc_velocity(l, i, t));
	if (l->top)
		store_turned(l, i, t);
}
