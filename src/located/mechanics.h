/* SPDX-License-Identifier: MIT */
/*
 * Contact points and bodies in the form of constraint/simultaneous, and responses to impulses.
 * Simulator's thread.
 */
#ifndef RB_LOCATED_MECHANICS_H
#define RB_LOCATED_MECHANICS_H

#include "located/pair_contacts.h"
#include "constraint/simultaneous.h"

/* The contact without its bodies' indices, mode, slip, impulse, and the noise that impacts need. */
struct rb_solver_contact rb_mechanics_contact(const struct rb_located *l,
                                              const struct rb_contact_point *m);

/*
 * A dynamic body, with velocities for an impact or, for forces, accelerations without contacts; and
 * the root of its inverse inertia in a pose, zero if that is a multiple of the identity.
 */
struct rb_solver_body rb_mechanics_body(const struct rb_located *l, int i, rb_vec3 linear,
                                        rb_vec3 angular);
rb_mat3 rb_mechanics_root(const struct rb_located *l, int i, const struct rb_pose *pose);
/*
 * A fixed (static or driven) body with its accelerations at `t`. Each contact gets its own copy,
 * since contacts that share a body are solved together.
 */
struct rb_solver_body rb_mechanics_fixed(const struct rb_located *l, int i, double t);

/* Velocity change at the point at `at` of a dynamic body due to an impulse at `arm`. */
rb_vec3 rb_mechanics_point_response(const struct rb_located *l, int i, const struct rb_pose *pose,
                                    rb_vec3 arm, rb_vec3 at, rb_vec3 impulse);

/* Adds K of a dynamic body (constraint/effective_mass) to k, world axes. */
void rb_mechanics_add_effective_mass(const struct rb_located *l, int i, const struct rb_pose *pose,
                                     rb_vec3 arm, rb_mat3 *k);

/* Velocity changes of a dynamic body due to an impulse at `arm`: m/s, rad/s. */
struct rb_mechanics_change {
	rb_vec3 linear, angular;
};
struct rb_mechanics_change rb_mechanics_change(const struct rb_located *l, int i,
                                               rb_quat orientation, rb_vec3 arm, rb_vec3 impulse);

/*
 * Contact points of bodies in the set, and motions that impulses at them cause: the operator J M^-1
 * J^T of drift correction and Painleve impacts.
 */
struct rb_mechanics_points {
	const struct rb_located *l;
	const struct rb_contact_point *contact_point;
	const int *row; /* [count]: indices of these; NULL: all */
	int count;
	const struct rb_pose *pose; /* [body_count], by l->place */
	int body_count;
	rb_vec3 *linear, *angular; /* [body_count]: velocities of the centres of mass, and spins */
};

/* Sets the motions of all bodies to those caused by impulses, [count], on b of each point. */
void rb_mechanics_respond(const struct rb_mechanics_points *points, const rb_vec3 *impulse);
/* Velocity of b relative to a at point k due to these motions. */
rb_vec3 rb_mechanics_response(const struct rb_mechanics_points *points, int k);

/* Angular acceleration of a body on a piece, rad/s^2; zero for any other. */
rb_vec3 rb_mechanics_turning(const struct rb_located *l, int i, double t);

#endif
