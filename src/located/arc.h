/* SPDX-License-Identifier: MIT */
/* Where a body is on its arc at a moment. `i` may be a static body. */
#ifndef RB_LOCATED_ARC_H
#define RB_LOCATED_ARC_H

#include "located/located.h"
#include "math/decay.h"
#include "math/pose.h"

/* Moves it; what rounding leaves out of that goes to its rest. */
static inline void rb_arc_move(struct rb_pose *pose, rb_vec3 way)
{
	const rb_vec3 before = pose->position, step = rb_vec3_add(way, pose->rest);

	pose->position = rb_vec3_add(before, step);
	pose->rest = rb_vec3_lost(before, step, pose->position);
}

/* Moves a pose of body i by small ways of its centre of mass, m, and turns, rad: corrections. */
void rb_arc_displace(const struct rb_located *l, int i, struct rb_pose *pose, rb_vec3 way,
                     rb_vec3 turn);

/* Three rows of the piece that the body is on. */
rb_vec3 rb_arc_piece_vector(const struct rb_piece_of *p, int row, double t);
rb_vec3 rb_arc_piece_rate(const struct rb_piece_of *p, int row, double t);
rb_vec3 rb_arc_piece_position(const struct rb_piece_of *p, double t);

static inline rb_vec3 rb_arc_position(const struct rb_located *l, int i, double t)
{
	if (i >= l->n)
		return l->model->position[i];
	if (rb_located_on_piece(l, i))
		return rb_arc_piece_position(&l->piece[i], t);
	const struct rb_arc *arc = &l->arc[i];
	const double s = t - arc->anchor_s;

	if (arc->decay > 0)
		return rb_vec3_add(arc->position,
		                   rb_decay_way(arc->decay, s, arc->velocity, arc->acceleration));
	return rb_vec3_add_scaled(arc->position, s,
	                          rb_vec3_add_scaled(arc->velocity, 0.5 * s, arc->acceleration));
}

static inline rb_vec3 rb_arc_velocity(const struct rb_located *l, int i, double t)
{
	if (i >= l->n)
		return (rb_vec3){0, 0, 0};
	if (rb_located_on_piece(l, i))
		return rb_arc_piece_vector(&l->piece[i], RB_PIECE_VELOCITY, t);
	const struct rb_arc *arc = &l->arc[i];

	if (arc->decay > 0)
		return rb_decay_velocity(arc->decay, t - arc->anchor_s, arc->velocity,
		                         arc->acceleration);
	return rb_vec3_add_scaled(arc->velocity, t - arc->anchor_s, arc->acceleration);
}

/* Of the centre of mass; of a piece, the derivative of its velocity. */
rb_vec3 rb_arc_acceleration(const struct rb_located *l, int i, double t);
/* A bound on it for as long as the body is on this arc or piece, m/s^2. */
double rb_arc_acceleration_max(const struct rb_located *l, int i);
struct rb_pose rb_arc_pose(const struct rb_located *l, int i, double t);

/* Centre of the shape; of one that is not in the centre of mass. */
rb_vec3 rb_arc_off_center(const struct rb_located *l, int i, double t);
static inline rb_vec3 rb_arc_origin(const struct rb_located *l, int i, double t)
{
	if (i >= l->n || !l->model->center_of_mass)
		return rb_arc_position(l, i, t);
	return rb_arc_off_center(l, i, t);
}

/* The rate at which a body's arc decays, 1/s; 0: it is a parabola, a piece, or fixed. */
static inline double rb_arc_decay(const struct rb_located *l, int i)
{
	return l->decays && i < l->n && !rb_located_on_piece(l, i) ? l->arc[i].decay : 0;
}

/*
 * The body starts a new arc here: a parabola, turning freely with `turning` (rad/s^2) on top.
 * rb_arc_slow then makes it one that decays, of which `acceleration` is that by constant forces.
 */
void rb_arc_anchor(struct rb_located *l, int i, double t, const struct rb_pose *pose,
                   rb_vec3 acceleration, rb_vec3 turning);

void rb_arc_slow(struct rb_located *l, int i, double decay);

/* Writes the body's row of the world's state as of `t`. */
void rb_arc_store(const struct rb_located *l, int i, double t);

#endif
