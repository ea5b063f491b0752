/* SPDX-License-Identifier: MIT */
/*
 * Contacts of a step as rows of one complementarity problem between impulses and velocities at the
 * step's end.
 *
 * For every row, with u the velocity of b relative to a at its point: u_n >= leave, push >= 0, one
 * of them at its bound; across the normal no slip, or friction against it at the cone. Impulses act
 * on b, their opposites on a. Arrays belong to the step that made them.
 */
#ifndef RB_STEPPED_ROW_H
#define RB_STEPPED_ROW_H

#include <float.h>
#include <stdbool.h>
#include <stdint.h>

#include "constraint/body.h"

/* Slip that is left opens no gap and closes none: of a residual it counts by this share. */
#define RB_SLIP_SHARE 0.3

struct rb_system_row {
	int a, b;  /* bodies of the problem */
	int point; /* its place among the points of the step */
	/* between spheres, or a sphere and what does not yield: the arms are along the normal */
	bool central;
	rb_vec3 normal; /* unit, from a to b */
	rb_vec3 arm_a,
		arm_b; /* m, from the centres of mass; central: x is the length along the normal */
	double inverse_mass_n,
		inverse_mass_t; /* 1/kg: of the normal; bound for all directions across */
	double target_velocity; /* m/s */
	double friction;
	double push;              /* N s, >= 0 */
	rb_vec3 friction_impulse; /* N s, across the normal, |rub| <= friction push */
	rb_vec3 step;             /* scratch: last change */
};

/* Rows solved together. */
struct rb_row_system {
	struct rb_solver_body *body;
	const rb_mat3 *tensor; /* world axes, by body; NULL: none is needed */
	struct rb_system_row *row;
	int row_count;
};

/*
 * Whether each row is of two of so many bodies, has a unit normal and positive effective masses,
 * and an impulse in its cone: what every solver takes and leaves. For assertions.
 */
bool rb_system_is_sound(const struct rb_row_system *system, int bodies);

static inline rb_vec3 rb_system_turn(const struct rb_row_system *dense, int body, rb_vec3 torque)
{
	const double inverse = dense->body[body].inverse_inertia;

	return isnan(inverse) ? rb_mat3_apply(&dense->tensor[body], torque)
	                      : rb_vec3_scale(inverse, torque);
}

static inline rb_vec3 rb_system_arm_a(const struct rb_system_row *row)
{
	return row->central ? rb_vec3_scale(row->arm_a.x, row->normal) : row->arm_a;
}

static inline rb_vec3 rb_system_arm_b(const struct rb_system_row *row)
{
	return row->central ? rb_vec3_scale(row->arm_b.x, row->normal) : row->arm_b;
}

/* Relative velocity at the point, m/s. */
static inline rb_vec3 rb_system_velocity(const struct rb_row_system *dense,
                                         const struct rb_system_row *row)
{
	const struct rb_solver_body *a = &dense->body[row->a], *b = &dense->body[row->b];
	const rb_vec3 u = rb_vec3_sub(b->linear, a->linear);

	if (row->central) {
		const rb_vec3 w = {row->arm_b.x * b->angular.x - row->arm_a.x * a->angular.x,
		                   row->arm_b.x * b->angular.y - row->arm_a.x * a->angular.y,
		                   row->arm_b.x * b->angular.z - row->arm_a.x * a->angular.z};

		return rb_vec3_add(u, rb_vec3_cross(w, row->normal));
	}
	return rb_vec3_add(u, rb_vec3_sub(rb_vec3_cross(b->angular, row->arm_b),
	                                  rb_vec3_cross(a->angular, row->arm_a)));
}

/* An impulse on b and its opposite on a. */
static inline void rb_system_apply(const struct rb_row_system *dense,
                                   const struct rb_system_row *row, rb_vec3 impulse)
{
	struct rb_solver_body *a = &dense->body[row->a], *b = &dense->body[row->b];

	/* what does not yield may be shared: not written to */
	if (a->inverse_mass != 0)
		a->linear = rb_vec3_add_scaled(a->linear, -a->inverse_mass, impulse);
	if (row->central) {
		const rb_vec3 torque = rb_vec3_cross(row->normal, impulse);

		a->angular = rb_vec3_add_scaled(a->angular, -a->inverse_inertia * row->arm_a.x,
		                                torque);
		if (b->inverse_mass == 0)
			return;
		b->linear = rb_vec3_add_scaled(b->linear, b->inverse_mass, impulse);
		b->angular = rb_vec3_add_scaled(b->angular, b->inverse_inertia * row->arm_b.x,
		                                torque);
		return;
	}
	if (a->inverse_inertia != 0)
		a->angular = rb_vec3_sub(
			a->angular,
			rb_system_turn(dense, row->a, rb_vec3_cross(row->arm_a, impulse)));
	if (b->inverse_mass == 0)
		return;
	b->linear = rb_vec3_add_scaled(b->linear, b->inverse_mass, impulse);
	if (b->inverse_inertia != 0)
		b->angular = rb_vec3_add(
			b->angular,
			rb_system_turn(dense, row->b, rb_vec3_cross(row->arm_b, impulse)));
}

static inline void rb_system_clear(struct rb_system_row *row)
{
	row->push = 0;
	row->friction_impulse = (rb_vec3){0, 0, 0};
}

/* The impulse as a vector, N s on b. */
static inline rb_vec3 rb_system_impulse(const struct rb_system_row *row)
{
	return rb_vec3_add_scaled(row->friction_impulse, row->push, row->normal);
}

/*
 * What the impulses take from bodies that move and do not yield, J; such a body is the second of
 * its rows.
 */
static inline double rb_system_work(const struct rb_row_system *dense)
{
	double sum = 0;

	for (int k = 0; k < dense->row_count; k++) {
		const struct rb_system_row *row = &dense->row[k];
		const struct rb_solver_body *b = &dense->body[row->b];

		if (b->inverse_mass == 0)
			sum -= rb_vec3_dot(
				rb_system_impulse(row),
				rb_vec3_add(b->linear,
			                    rb_vec3_cross(b->angular, rb_system_arm_b(row))));
	}
	return sum;
}

#endif
