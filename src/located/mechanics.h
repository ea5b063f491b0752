/* SPDX-License-Identifier: MIT */
/* A contact point of two bodies as a contact of constraint/simultaneous. */
#ifndef RB_LOCATED_MECHANICS_H
#define RB_LOCATED_MECHANICS_H

#include "located/pair_contacts.h"
#include "constraint/simultaneous.h"

/* All but its bodies' places, mode, slip and impulse, and the noise that impacts ask for. */
struct rb_solver_contact rb_mechanics_contact(const struct rb_located *l,
                                              const struct rb_contact_point *m);

/*
 * A dynamic body: its velocities are those of an impact, or accelerations apart from contacts. And
 * the root of its inverse inertia in a pose: zero where that is a multiple of one.
 */
struct rb_solver_body rb_mechanics_body(const struct rb_located *l, int i, rb_vec3 linear,
                                        rb_vec3 angular);
rb_mat3 rb_mechanics_root(const struct rb_located *l, int i, const struct rb_pose *pose);
/*
 * One that does not, with its accelerations at `t`: static, or driven. Each contact gets a copy of
 * its own, since what shares a body is solved together.
 */
struct rb_solver_body rb_mechanics_fixed(const struct rb_located *l, int i, double t);

/* What an impulse on a body that yields, at `arm`, adds to the velocity of its point at `at`. */
rb_vec3 rb_mechanics_answer(const struct rb_located *l, int i, const struct rb_pose *pose,
                            rb_vec3 arm, rb_vec3 at, rb_vec3 impulse);

/* K of a body that yields (constraint/effective_mass), added to k, world axes. */
void rb_mechanics_add_effective_mass(const struct rb_located *l, int i, const struct rb_pose *pose,
                                     rb_vec3 arm, rb_mat3 *k);

/* What an impulse at `arm` changes the velocities of a body that yields by: m/s, rad/s. */
struct rb_mechanics_change {
	rb_vec3 linear, angular;
};
struct rb_mechanics_change rb_mechanics_change(const struct rb_located *l, int i,
                                               rb_quat orientation, rb_vec3 arm, rb_vec3 impulse);

/*
 * Contact points of bodies that have places, and motions that impulses there cause: the operator
 * J M^-1 J^T of drift correction and of Painleve impacts.
 */
struct rb_mechanics_points {
	const struct rb_located *l;
	const struct rb_contact_point *contact_point;
	const int *row; /* [count]: which of these; NULL: all */
	int count;
	const struct rb_pose *pose; /* [body_count], by place */
	int body_count;
	rb_vec3 *linear, *angular; /* [body_count]: of the centres of mass, and spins */
};

/* Sets motions of all bodies to what impulses on b of each point, [count], cause. */
void rb_mechanics_respond(const struct rb_mechanics_points *points, const rb_vec3 *impulse);
/* What these motions add to the velocity of b relative to a at point k. */
rb_vec3 rb_mechanics_response(const struct rb_mechanics_points *points, int k);

/* Angular acceleration of a body on a piece, rad/s^2; zero of any other. */
rb_vec3 rb_mechanics_turning(const struct rb_located *l, int i, double t);

#endif
