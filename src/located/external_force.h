/* SPDX-License-Identifier: MIT */
/*
 * What accelerates a body apart from contact: weights, stated forces, force elements, fields.
 *
 * A force has a closed form when its acceleration is constant from now to the next switch of
 * forces, apart from linear drag of what flies; all others call for the integrator
 * (located/integrate).
 */
#ifndef RB_LOCATED_EXTERNAL_FORCE_H
#define RB_LOCATED_EXTERNAL_FORCE_H

#include "located/arc.h"

/*
 * Forces of a body by what the ledger enters them under; those between bodies are entered one by
 * one.
 */
enum rb_external_cause {
	RB_EXTERNAL_UNIFORM, /* gravity, gravity_force, elements: what has a potential */
	RB_EXTERNAL_STATED,  /* `forces`, fields, elements without a potential */
	RB_EXTERNAL_CALLBACKS,
	RB_EXTERNAL_DRAG,
	RB_EXTERNAL_SPRINGS,
	RB_EXTERNAL_GRAVITATION,
	RB_EXTERNAL_CAUSES
};

struct rb_external_parts {
	rb_vec3 force[RB_EXTERNAL_CAUSES],
		torque[RB_EXTERNAL_CAUSES]; /* N; N m about the centre of mass */
};

/* Poses of the bodies that are dealt with together; all others are on their arcs. */
struct rb_force_query {
	const struct rb_pose *pose; /* [..], by l->place; NULL: all on their arcs */
	double time_s;
	double active_s; /* the moment that says which forces act: the beginning of the piece */
	struct rb_external_parts *parts; /* [..], by l->place: out; NULL: nobody asks */
	bool attracted;                  /* rb_external_attract has been called with this query */
};

/*
 * Gravitation on all bodies at the query's moment, from their poses there, to l->gravitation. In
 * scenes without it nothing is done.
 */
void rb_external_attract(struct rb_located *l, const struct rb_force_query *view);

/* How force elements see bodies that are located: what their query's `user` is. */
struct rb_element_view {
	const struct rb_located *l;
	const struct rb_force_query *view;
};
struct rb_element_query rb_external_query(const struct rb_element_view *at);

/*
 * Acceleration of the centre of mass and of the turning, gyroscopic term included, m/s^2 and
 * rad/s^2. Sets l->status where a field's function fails.
 */
void rb_external_force_at(struct rb_located *l, int i, const struct rb_pose *pose,
                          const struct rb_force_query *view, rb_vec3 *linear, rb_vec3 *angular);

/*
 * rb_external_force_at where gravity and gravitation are all that acts, nothing turns and nobody
 * asks for parts: only the attraction must have been found. False: it is no such scene.
 */
static inline bool rb_external_is_attraction(const struct rb_located *l)
{
	return !l->top && (l->model->features & RB_FEATURE_GRAVITATION) &&
	       !(l->model->features &
	         (RB_FEATURE_GRAVITY_FORCE | RB_FEATURE_FORCES | RB_FEATURE_PUSHES |
	          (RB_FEATURES_VARIED & ~(rb_features)RB_FEATURE_GRAVITATION)));
}

/* Whether both are constant from `t` to the next switch as long as nothing touches the body. */
bool rb_external_is_constant(const struct rb_located *l, int i, double t);
/* ... as long as neither the body nor anything that is attracted moves. */
bool rb_external_is_constant_at_rest(const struct rb_located *l, int i, double t);
/*
 * As rb_external_is_constant, but for linear drag: the rate at which it takes velocities, 1/s, of
 * which the force is then constant at no velocity. NAN: more than that acts.
 */
double rb_external_decay(const struct rb_located *l, int i, double t);
/* Acceleration by what is constant of it, m/s^2, where that is all but drag. */
rb_vec3 rb_external_constant(struct rb_located *l, int i, double t, const struct rb_pose *pose);
/* Is the drag of the scene, if there is any, linear? */
bool rb_external_drag_is_linear(const struct rb_model *model);
/* The turning by torques only, where rb_external_is_constant: what rb_arc_anchor wants. */
rb_vec3 rb_external_turning(const struct rb_located *l, int i);

/*
 * Does a stated force or a force element act at a point that turns with the body, or along its
 * axes?
 */
bool rb_external_turns_with(const struct rb_located *l, int i);

/* I^-1 applied to an angular impulse, world axes. */
rb_vec3 rb_inverse_inertia_apply(const struct rb_located *l, int i, rb_quat orientation,
                                 rb_vec3 torque);

/* Moments at which forces of bodies begin and end, sorted, without repeats; false: no memory. */
bool rb_external_switches(struct rb_located *l);

#endif
