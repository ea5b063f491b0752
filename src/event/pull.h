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

/* Forces of a body by what the ledger enters them under; those of springs are entered spring by spring. */
enum rb_pull_cause {
	RB_PULL_UNIFORM, /* gravity, gravity_force: they have a potential */
	RB_PULL_STATED,  /* `forces`, fields */
	RB_PULL_PUSHED,
	RB_PULL_DRAG,
	RB_PULL_SPRINGS,
	RB_PULL_CAUSES
};

struct rb_pull_parts {
	rb_vec3 force[RB_PULL_CAUSES], torque[RB_PULL_CAUSES]; /* N; N m about the centre of mass */
};

/* Poses of the bodies that are dealt with together; all others are on their arcs. */
struct rb_view {
	const struct rb_pose *pose; /* [..], by l->place; NULL: all on their arcs */
	double time_s;
	double active_s; /* the moment that says which forces act: the beginning of the piece */
	struct rb_pull_parts *parts; /* [..], by l->place: out; NULL: nobody asks */
};

/* A spring at one moment; the force on its other end is the opposite. */
struct rb_pull_spring {
	rb_vec3 force;            /* N, on a */
	rb_vec3 end_a, end_b;     /* m, world */
	rb_vec3 speed_a, speed_b; /* m/s, of the ends */
	double damping;           /* W, >= 0: what its damper takes */
};

/* False: it has no direction to pull in. */
bool rb_pull_spring_at(const struct rb_located *l, int spring, const struct rb_view *view,
                       struct rb_pull_spring *out);

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

/* Does a stated force or a spring act at a point that turns with the body, or along its axes? */
bool rb_pull_turns_with(const struct rb_located *l, int i);

/* I^-1 applied to an angular impulse, world axes. */
rb_vec3 rb_pull_yield(const struct rb_located *l, int i, rb_quat orientation, rb_vec3 torque);

/* Moments at which forces of bodies begin and end, sorted, without repeats; false: no memory. */
bool rb_pull_switches(struct rb_located *l);

#endif
