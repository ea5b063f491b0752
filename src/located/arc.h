/* SPDX-License-Identifier: MIT */
/* Position and motion of a body on its arc at a time. `i` may be a static body. */
#ifndef RB_LOCATED_ARC_H
#define RB_LOCATED_ARC_H

#include "located/located.h"
#include "math/decay.h"
#include "math/pose.h"

/* Moves a pose; the rounding remainder is kept in its rest. */
static inline void rb_arc_move(struct rb_pose *pose, rb_vec3 way)
{
	const rb_vec3 before = pose->position, step = rb_vec3_add(way, pose->rest);

	pose->position = rb_vec3_add(before, step);
	pose->rest = rb_vec3_lost(before, step, pose->position);
}

/*
 * Moves a pose of body i by a small displacement of its centre of mass, m, and a small rotation,
 * rad: corrections.
 */
void rb_arc_displace(const struct rb_located *l, int i, struct rb_pose *pose, rb_vec3 way,
                     rb_vec3 turn);

/* Three rows of a piece, their rates, and the position. */
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

/* Acceleration of the centre of mass; on a piece, the derivative of its velocity. */
rb_vec3 rb_arc_acceleration(const struct rb_located *l, int i, double t);
/* Bound on that acceleration while the body is on this arc or piece, m/s^2. */
double rb_arc_acceleration_max(const struct rb_located *l, int i);
struct rb_pose rb_arc_pose(const struct rb_located *l, int i, double t);

/* Origin of the shape if it is not the centre of mass; in any case. */
rb_vec3 rb_arc_off_center(const struct rb_located *l, int i, double t);
static inline rb_vec3 rb_arc_origin(const struct rb_located *l, int i, double t)
{
	if (i >= l->n || !l->model->center_of_mass)
		return rb_arc_position(l, i, t);
	return rb_arc_off_center(l, i, t);
}

/* Rate of decay of a body's arc, 1/s; 0: it is a parabola or a piece, or the body is static. */
static inline double rb_arc_decay(const struct rb_located *l, int i)
{
	return l->decays && i < l->n && !rb_located_on_piece(l, i) ? l->arc[i].decay : 0;
}

/*
 * Starts a new arc at this pose: a parabola, rotating freely with an additional angular
 * acceleration `turning`, rad/s^2. rb_arc_set_drag then adds linear drag of rate `decay`;
 * `acceleration` is that by constant forces.
 */
void rb_arc_anchor(struct rb_located *l, int i, double t, const struct rb_pose *pose,
                   rb_vec3 acceleration, rb_vec3 turning);

void rb_arc_set_drag(struct rb_located *l, int i, double decay);

/* Writes the body's row of the world's state as of `t`. */
void rb_arc_store(const struct rb_located *l, int i, double t);

#endif
