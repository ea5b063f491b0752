/* SPDX-License-Identifier: MIT */
/*
 * One constraint of two bodies: a direction, or three, along which their relative velocity is held,
 * and the set that its impulse may lie in. What every solver of every method takes.
 *
 * With u the velocity of b relative to a at the place of the constraint, p the impulse on b (its
 * opposite acts on a), n the normal, w the target, and K = M_a^-1 + M_b^-1 seen from that place
 * (constraint/effective_mass):
 *
 *     set        impulse p                                       velocity u
 *     CONE       p_n >= 0, |p_t| <= mu p_n                       u_n >= w_n, one of both at its
 *                                                                bound; u_t = 0, or p_t against it
 *                                                                on the cone's edge
 *     FREE       any                                             u = w, in three directions
 *     INTERVAL   p_t = 0, low <= p_n <= high                     u_n + s p_n = w_n, or below it
 *                                                                at p_n = high, above it at low
 *
 * A contact is a CONE (constraint/contact_row); a ball joint FREE; a motor or the friction of a
 * joint INTERVAL [-tau h, tau h]; a limit or a taut rope INTERVAL [0, inf); a hinge FREE with two
 * INTERVALs (-inf, inf) that are couples; a spring of stiffness k and damping c at the end of a
 * step h, stretched by x, INTERVAL (-inf, inf) with softness s = 1/(h (h k + c)), w = -s h k x.
 * Bounds of one constraint depend on no other one.
 *
 * Where the two bodies are taken:
 *
 *     at arms    u = v_b + w_b x r_b - v_a - w_a x r_a           any shapes
 *     central    the same with arms along the normal: three products less   spheres
 *     couple     u = l (w_b - w_a), torque l p                   what turns: l, a length, makes
 *                                                                units, tolerances and shares those
 *                                                                of the others; any size of a body
 *
 * Who solves what:
 *
 *     stepped/gauss_seidel   all sets: blocks of a constraint exactly, one after the other
 *     stepped/wide           CONE alone, four at a time (stepped/sweeper chooses)
 *     stepped/direct         all sets: augmented Lagrangian, factors; chains and unequal masses
 *     constraint/cone        all sets, none of them soft: free of order and handedness
 *     constraint/eccentric, impulse   one CONE alone, the impact law; CONEs of the classic method
 *     math/dense (located/modes)      CONEs whose mode is known: equations
 *
 * Drift of positions is corrected with the same rows, their errors C in place of velocities: of all
 * motions d of the bodies with multipliers p, d = M^-1 J^T p, that with
 *
 *     J d = -C, p of any sign        what is held, contacts and joints, from both sides and to
 *                                    rounding: conjugate residuals, which do not depend on order,
 *                                    and factors of joints (located/drift, joint_rows)
 *     J d >= -C, p >= 0              overlaps in a crowd, until they are within the tolerance: the
 *                                    solver of the step, without friction (stepped/projection)
 *
 * Two algorithms, for the first would pull open gaps of a crowd shut, and the second ends within
 * the tolerance of steps, where pieces need 1e-9 of sizes (rb_drift_correct). What both are made of
 * stands once: rows, K (constraint/effective_mass), how a pose is turned (rb_quat_turned).
 *
 * Private scratch of a solver stands beside the rows, in arrays or around them, never in copies.
 */
#ifndef RB_CONSTRAINT_ROW_H
#define RB_CONSTRAINT_ROW_H

#include "constraint/body.h"

enum rb_constraint_set { RB_CONSTRAINT_CONE, RB_CONSTRAINT_FREE, RB_CONSTRAINT_INTERVAL };

/* Along the normal, and what is across it as a vector. */
typedef struct {
	double n;
	rb_vec3 t;
} rb_along_across;

struct rb_constraint {
	int a, b; /* bodies of the problem */
	enum rb_constraint_set set;
	bool central;   /* arms are along the normal, inertias multiples of one; CONE alone */
	bool couple;    /* turns only: arm_a.x is its lever; neither central nor a CONE */
	rb_vec3 normal; /* unit, from a to b; FREE: any unit vector */
	/* m, from the centres of mass; central: x is the length along the normal */
	rb_vec3 arm_a, arm_b;
	/* 1/kg: n.K n, and a bound of t.K t for all unit vectors across (rb_effective_mass_fill) */
	double inverse_mass_n, inverse_mass_t;
	double friction;         /* CONE */
	double low, high;        /* INTERVAL: N s, may be infinite */
	double softness;         /* INTERVAL: 1/kg, >= 0 */
	rb_along_across target;  /* m/s; its `t` of FREE only */
	rb_along_across impulse; /* N s on b: a warm start, then what was found */
};

/* Rows solved together. */
struct rb_row_system {
	struct rb_solver_bodies bodies;
	struct rb_constraint *row;
	int row_count;
};

/*
 * Whether each row is of two of so many bodies, has a unit normal and positive effective masses,
 * and an impulse in its set: what every solver takes and leaves. For assertions.
 */
bool rb_row_system_is_sound(const struct rb_row_system *system, int bodies);

/*
 * Leaves out of the impulses across the normals what lies along them: rounding of speeds far above
 * those that a solution ends with.
 */
void rb_row_system_reject_normals(const struct rb_row_system *system);

/* Each row has a set that `wide` and the classic method take. */
bool rb_row_system_is_of_contacts(const struct rb_row_system *system);

static inline rb_along_across rb_constraint_split(const struct rb_constraint *row, rb_vec3 v)
{
	const double n = rb_vec3_dot(v, row->normal);

	return (rb_along_across){n, rb_vec3_add_scaled(v, -n, row->normal)};
}

static inline rb_vec3 rb_constraint_joined(const struct rb_constraint *row, rb_along_across p)
{
	return rb_vec3_add_scaled(p.t, p.n, row->normal);
}

static inline rb_vec3 rb_constraint_arm_a(const struct rb_constraint *row)
{
	return row->central ? rb_vec3_scale(row->arm_a.x, row->normal) : row->arm_a;
}

static inline rb_vec3 rb_constraint_arm_b(const struct rb_constraint *row)
{
	return row->central ? rb_vec3_scale(row->arm_b.x, row->normal) : row->arm_b;
}

/* Of couples: apart, so that what contacts take stays short. */
rb_vec3 rb_constraint_couple_velocity(const struct rb_solver_bodies *bodies,
                                      const struct rb_constraint *row);
void rb_constraint_couple_apply(const struct rb_solver_bodies *bodies,
                                const struct rb_constraint *row, rb_vec3 impulse);

/* Velocity of b relative to a, m/s. Every sweep begins with it: a call costs boxes 3 %. */
static inline __attribute__((always_inline)) rb_vec3 rb_constraint_velocity(
	const struct rb_solver_bodies *bodies, const struct rb_constraint *row)
{
	const struct rb_solver_body *a = &bodies->body[row->a], *b = &bodies->body[row->b];
	const rb_vec3 u = rb_vec3_sub(b->linear, a->linear);

	if (row->central) {
		const rb_vec3 w = {row->arm_b.x * b->angular.x - row->arm_a.x * a->angular.x,
		                   row->arm_b.x * b->angular.y - row->arm_a.x * a->angular.y,
		                   row->arm_b.x * b->angular.z - row->arm_a.x * a->angular.z};

		return rb_vec3_add(u, rb_vec3_cross(w, row->normal));
	}
	if (row->couple)
		return rb_constraint_couple_velocity(bodies, row);
	return rb_vec3_add(u, rb_vec3_sub(rb_vec3_cross(b->angular, row->arm_b),
	                                  rb_vec3_cross(a->angular, row->arm_a)));
}

/* An impulse on b and its opposite on a. */
static inline void rb_constraint_apply(const struct rb_solver_bodies *bodies,
                                       const struct rb_constraint *row, rb_vec3 impulse)
{
	struct rb_solver_body *a = &bodies->body[row->a], *b = &bodies->body[row->b];

	if (row->couple) {
		rb_constraint_couple_apply(bodies, row, impulse);
		return;
	}
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
			rb_solver_turn(bodies, row->a, rb_vec3_cross(row->arm_a, impulse)));
	if (b->inverse_mass == 0)
		return;
	b->linear = rb_vec3_add_scaled(b->linear, b->inverse_mass, impulse);
	if (b->inverse_inertia != 0)
		b->angular = rb_vec3_add(
			b->angular,
			rb_solver_turn(bodies, row->b, rb_vec3_cross(row->arm_b, impulse)));
}

/*
 * Which way a row pushes and never pulls: 1 along its normal (contacts, limits), -1 against it
 * (ropes, limits of the other side), 0 if it may do both.
 */
static inline int rb_constraint_side(const struct rb_constraint *row)
{
	if (row->set == RB_CONSTRAINT_CONE)
		return 1;
	if (row->set == RB_CONSTRAINT_FREE || row->softness > 0)
		return 0;
	return (row->low == 0 && row->high > 0) - (row->high == 0 && row->low < 0);
}

/*
 * Moves the ends of both arms, `gap` m of b's from a's, to the middle between them: what acts at
 * one point leaves the angular momentum of both as it is.
 */
static inline void rb_constraint_join_arms(struct rb_constraint *row, rb_vec3 gap)
{
	if (row->central) {
		const double half = 0.5 * rb_vec3_dot(gap, row->normal);

		row->arm_a.x += half;
		row->arm_b.x -= half;
		return;
	}
	row->arm_a = rb_vec3_add_scaled(row->arm_a, 0.5, gap);
	row->arm_b = rb_vec3_add_scaled(row->arm_b, -0.5, gap);
}

static inline void rb_constraint_clear(struct rb_constraint *row)
{
	row->impulse = (rb_along_across){0, {0, 0, 0}};
}

/* The impulse as a vector, N s on b. */
static inline rb_vec3 rb_constraint_impulse(const struct rb_constraint *row)
{
	return rb_constraint_joined(row, row->impulse);
}

/* Shortened to `max` where it is longer: a cone's circle. */
static inline rb_vec3 rb_constraint_within(rb_vec3 t, double max)
{
	const double square = rb_vec3_dot(t, t);

	return square > max * max ? rb_vec3_scale(max / sqrt(square), t) : t;
}

/*
 * An impulse brought into its set: the normal part first, then what is across it within what that
 * allows. (Of a cone it is not the nearest one: that is stepped/direct's.)
 */
static inline rb_along_across rb_constraint_project(const struct rb_constraint *row,
                                                    rb_along_across p)
{
	switch (row->set) {
	case RB_CONSTRAINT_FREE:
		return p;
	case RB_CONSTRAINT_INTERVAL:
		return (rb_along_across){fmin(fmax(p.n, row->low), row->high), {0, 0, 0}};
	case RB_CONSTRAINT_CONE:
		break;
	}
	p.n = fmax(0, p.n);
	p.t = rb_constraint_within(p.t, row->friction * p.n);
	return p;
}

/*
 * What the impulses take from bodies that move and are not dynamic, J; such a body is the second of
 * its rows.
 */
static inline double rb_row_system_work(const struct rb_row_system *system)
{
	double sum = 0;

	for (int k = 0; k < system->row_count; k++) {
		const struct rb_constraint *row = &system->row[k];
		const struct rb_solver_body *b = &system->bodies.body[row->b];

		if (b->inverse_mass == 0 && row->couple)
			sum -= row->arm_a.x * rb_vec3_dot(rb_constraint_impulse(row), b->angular);
		else if (b->inverse_mass == 0)
			sum -= rb_vec3_dot(rb_constraint_impulse(row),
			                   rb_solver_point_velocity(b, rb_constraint_arm_b(row)));
	}
	return sum;
}

#endif
