/* SPDX-License-Identifier: MIT */
/*
 * What accelerates a body apart from contact: one row a force in pull.c.
 *
 * A force has a closed form when its acceleration is constant from now to the next switch of forces; all others call
 * for the integrator (event/integrate).
 */
#ifndef RB_EVENT_PULL_H
#define RB_EVENT_PULL_H

#include "event/arc.h"

/* Poses of the bodies that are dealt with together; all others are on their arcs. */
struct rb_view {
	const struct rb_pose *pose; /* [..], by l->place; NULL: all on their arcs */
	double time_s;
	double active_s; /* the moment that says which forces act: the beginning of the piece */
};

/*
 * Acceleration of the centre of mass and of the turning, gyroscopic term included, m/s^2 and rad/s^2. Sets l->status
 * where a field's function fails.
 */
void rb_pull_at(struct rb_located *l, int i, const struct rb_pose *pose, const struct rb_view *view,
                rb_vec3 *linear, rb_vec3 *angular);

/* Whether both are constant from `t` to the next switch as long as nothing touches the body. */
bool rb_pull_is_constant(const struct rb_located *l, int i, double t);
/* The turning by torques only, where rb_pull_is_constant: what rb_arc_anchor wants. */
rb_vec3 rb_pull_turning(const struct rb_located *l, int i);

/* I^-1 applied to an angular impulse, world axes. */
rb_vec3 rb_pull_yield(const struct rb_located *l, int i, rb_quat orientation, rb_vec3 torque);

/* Moments at which forces of bodies begin and end, sorted, without repeats; false: no memory. */
bool rb_pull_switches(struct rb_located *l);

#endif
