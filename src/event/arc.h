/* SPDX-License-Identifier: MIT */
/* Where a body is on its arc at a moment. `i` may be a static body. */
#ifndef RB_EVENT_ARC_H
#define RB_EVENT_ARC_H

#include "event/located.h"

/* All of a body at one moment. */
struct rb_pose {
	rb_vec3 position; /* centre of mass */
	rb_vec3 origin;   /* of the object, centre of its shape */
	rb_quat orientation;
	rb_vec3 velocity, spin;
};

rb_vec3 rb_arc_position(const struct rb_located *l, int i, double t);
rb_vec3 rb_arc_velocity(const struct rb_located *l, int i, double t);
/* Of the centre of mass; of a piece, the derivative of its velocity. */
rb_vec3 rb_arc_acceleration(const struct rb_located *l, int i, double t);
struct rb_pose rb_arc_pose(const struct rb_located *l, int i, double t);

/* Centre of the shape, and its velocity. */
rb_vec3 rb_arc_origin(const struct rb_located *l, int i, double t);

/* The body starts a new arc here: a parabola, turning freely with `turning` (rad/s^2) on top. */
void rb_arc_anchor(struct rb_located *l, int i, double t, const struct rb_pose *pose,
                   rb_vec3 acceleration, rb_vec3 turning);

/* Writes the body's row of the world's state as of `t`. */
void rb_arc_store(const struct rb_located *l, int i, double t);

#endif
