/* SPDX-License-Identifier: MIT */
/*
 * External forces on a body: gravity, forces of the scene, force elements, fields, gravitation.
 *
 * A body's motion has a closed form if its acceleration is constant until the next switch of
 * forces, apart from linear drag in flight; all others need the integrator (located/integrate).
 * Simulator's thread.
 */
#ifndef RB_LOCATED_EXTERNAL_FORCE_H
#define RB_LOCATED_EXTERNAL_FORCE_H

#include "located/arc.h"

/* Forces on a body by their causes in the ledger; those between bodies are entered one by one. */
enum rb_external_cause {
	RB_EXTERNAL_UNIFORM, /* gravity, gravity_force, elements with a potential */
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

/* Poses of the bodies of the set; all others are on their arcs. */
struct rb_force_query {
	const struct rb_pose *pose; /* [..], by l->place; NULL: all are on their arcs */
	double time_s;
	double active_s; /* time that decides which forces act: the beginning of the piece */
	struct rb_external_parts *parts; /* output [..], by l->place; NULL: not wanted */
	bool attracted;                  /* rb_external_attract has been called with this query */
};

/*
 * Computes gravitation on all bodies, at the query's time and poses, in l->gravitation. Does
 * nothing in scenes without it.
 */
void rb_external_attract(struct rb_located *l, const struct rb_force_query *view);

/* Access of force elements to located bodies: the `user` of their query. */
struct rb_element_view {
	const struct rb_located *l;
	const struct rb_force_query *view;
};
struct rb_element_query rb_external_query(const struct rb_element_view *at);

/*
 * Acceleration of the centre of mass, m/s^2, and angular acceleration with the gyroscopic term,
 * rad/s^2. Sets l->status if a field's function fails.
 */
void rb_external_force_at(struct rb_located *l, int i, const struct rb_pose *pose,
                          const struct rb_force_query *view, rb_vec3 *linear, rb_vec3 *angular);

/*
 * Acceleration by the scene's field function alone, m/s^2, which is not counted: samples of it are
 * fewer than the calls of steps. Sets l->status if it fails.
 */
rb_vec3 rb_external_field(struct rb_located *l, int i, double t, rb_vec3 position,
                          rb_vec3 velocity);

/*
 * True if gravity and gravitation are the only external forces and bodies do not rotate: then
 * rb_external_force_at needs only the attraction, unless parts are wanted.
 */
static inline bool rb_external_is_attraction(const struct rb_located *l)
{
	return !l->top && (l->model->features & RB_FEATURE_GRAVITATION) &&
	       !(l->model->features &
	         (RB_FEATURE_GRAVITY_FORCE | RB_FEATURE_FORCES | RB_FEATURE_PUSHES |
	          (RB_FEATURES_VARIED & ~(rb_features)RB_FEATURE_GRAVITATION)));
}

/*
 * True if both accelerations are constant from `t` to the next switch while nothing touches the
 * body.
 */
bool rb_external_is_constant(const struct rb_located *l, int i, double t);
/* The same while neither the body nor any attracted body moves. */
bool rb_external_is_constant_at_rest(const struct rb_located *l, int i, double t);
/*
 * The same except for linear drag: returns its rate of decay of velocities, 1/s; the remaining
 * force is constant. NAN: other forces act.
 */
double rb_external_decay(const struct rb_located *l, int i, double t);
/* Acceleration by the constant forces, m/s^2, if all but drag are constant. */
rb_vec3 rb_external_constant(struct rb_located *l, int i, double t, const struct rb_pose *pose);
/* True if the scene has drag and all of it is linear. */
bool rb_external_drag_is_linear(const struct rb_model *model);
/*
 * Angular acceleration by torques only, if rb_external_is_constant: the `turning` of rb_arc_anchor.
 */
rb_vec3 rb_external_turning(const struct rb_located *l, int i);

/*
 * True if a force of the scene or a force element acts at a body-fixed point off the origin, or
 * along body axes.
 */
bool rb_external_turns_with(const struct rb_located *l, int i);

/* I^-1 applied to a torque or angular impulse, world axes. */
rb_vec3 rb_inverse_inertia_apply(const struct rb_located *l, int i, rb_quat orientation,
                                 rb_vec3 torque);

/*
 * Creates the times at which forces of bodies begin and end, sorted, without duplicates; false: no
 * memory.
 */
bool rb_external_switches(struct rb_located *l);

#endif
