/* SPDX-License-Identifier: MIT */
/*
 * A constraint between two bodies: one direction or three along which their relative velocity is
 * constrained, and the set that its impulse must lie in. The row of every solver of every method.
 *
 * With u the velocity of b relative to a at the constraint's point, p the impulse on b (its
 * opposite acts on a), n the normal, w the target, and K the inverse effective mass at that point,
 * M_a^-1 + M_b^-1 (constraint/effective_mass):
 *
 *     set        impulse p                                       velocity u
 *     CONE       p_n >= 0, |p_t| <= mu p_n                       u_n >= w_n, complementary;
 *                                                                u_t = 0, or |p_t| = mu p_n with
 *                                                                p_t opposite to u_t
 *     FREE       any                                             u = w, in three directions
 *     INTERVAL   p_t = 0, low <= p_n <= high                     u_n + s p_n = w_n; less at
 *                                                                p_n = high, more at p_n = low
 *
 * A contact is a CONE (constraint/contact_row); a ball joint FREE; a motor or the friction of a
 * joint INTERVAL [-tau h, tau h]; a limit or a taut rope INTERVAL [0, inf); a hinge FREE with two
 * INTERVALs (-inf, inf) that are couples; a spring of stiffness k and damping c at the end of a
 * step h, stretched by x, INTERVAL (-inf, inf) with softness s = 1/(h (h k + c)), w = -s h k x.
 * Bounds of a constraint do not depend on other constraints.
 *
 * How u follows from the two bodies' velocities:
 *
 *     at arms    u = v_b + w_b x r_b - v_a - w_a x r_a           any shapes
 *     central    the same with arms along the normal: three products fewer  spheres
 *     couple     u = l (w_b - w_a), torque l p                   rotational rows: the length l
 *                                                                gives them units and tolerances
 *                                                                of the others; any size of a body
 *
 * Solvers:
 *
 *     stepped/gauss_seidel   all sets: solves each constraint's block exactly, in turn
 *     stepped/wide           CONE only, four at a time (stepped/sweeper chooses)
 *     stepped/direct         all sets: augmented Lagrangian, factors; chains and unequal masses
 *     constraint/cone        all sets without softness: independent of order and handedness
 *     constraint/eccentric, impulse   a single CONE, the impact law; CONEs of the classic method
 *     math/dense (located/modes)      CONEs whose mode is known: linear equations
 *
 * Drift of positions is corrected with the same rows, with errors C in place of velocities: among
 * displacements d = M^-1 J^T p of the bodies with multipliers p, the one with
 *
 *     J d = -C, p of any sign        lasting contacts and joints, bilaterally and to rounding:
 *                                    conjugate residuals, which do not depend on order, and
 *                                    factors of joints (located/drift, joint_rows)
 *     J d >= -C, p >= 0              overlaps in a crowd, to within the tolerance: the solver of
 *                                    the step, without friction (stepped/projection)
 *
 * There are two algorithms because the first would close the open gaps of a crowd, and the second
 * ends at the tolerance of steps, whereas pieces need 1e-9 of sizes (rb_drift_correct). They share
 * rows, K (constraint/effective_mass) and the rotation of poses (rb_quat_turned).
 *
 * Private scratch of a solver is kept in arrays beside the rows or in structs around them, never in
 * copies of them.
 */
#ifndef RB_CONSTRAINT_ROW_H
#define RB_CONSTRAINT_ROW_H

#include "constraint/body.h"

enum rb_constraint_set { RB_CONSTRAINT_CONE, RB_CONSTRAINT_FREE, RB_CONSTRAINT_INTERVAL };

/* Normal component, and tangential part as a vector. */
typedef struct {
	double n;
	rb_vec3 t;
} rb_along_across;

struct rb_constraint {
	int a, b; /* bodies of the problem */
	enum rb_constraint_set set;
	bool central;   /* arms along the normal, isotropic inertias; CONE only */
	bool couple;    /* rotational: arm_a.x is its length; neither central nor a CONE */
	rb_vec3 normal; /* unit, from a to b; FREE: any unit vector */
	/* m, from the centres of mass; central: x is the length along the normal */
	rb_vec3 arm_a, arm_b;
	/* 1/kg: n.K n, and an upper bound of t.K t over tangents t (rb_effective_mass_fill) */
	double inverse_mass_n, inverse_mass_t;
	double friction;         /* CONE */
	double low, high;        /* INTERVAL: N s, may be infinite */
	double softness;         /* INTERVAL: 1/kg, >= 0 */
	rb_along_across target;  /* m/s; `t` is used by FREE only */
	rb_along_across impulse; /* N s on b; in: warm start, out: solution */
};

/* Rows solved together. */
struct rb_row_system {
	struct rb_solver_bodies bodies;
	struct rb_constraint *row;
	int row_count;
};

/*
 * Returns whether each row connects two of `bodies` bodies, has a unit normal, positive effective
 * masses and an impulse in its set, as every solver requires and guarantees. For assertions.
 */
bool rb_row_system_is_sound(const struct rb_row_system *system, int bodies);

/*
 * Removes the normal components of tangential impulses: rounding of speeds far above those of the
 * solution.
 */
void rb_row_system_reject_normals(const struct rb_row_system *system);

/* Returns whether all rows are CONEs, the only set that `wide` and the classic method take. */
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

/* Couples have functions of their own, so that the inlined code of contacts stays short. */
rb_vec3 rb_constraint_couple_velocity(const struct rb_solver_bodies *bodies,
                                      const struct rb_constraint *row);
void rb_constraint_couple_apply(const struct rb_solver_bodies *bodies,
                                const struct rb_constraint *row, rb_vec3 impulse);

/*
 * Velocity of b relative to a, m/s. Inlined: every sweep begins with it, and a call would slow
 * boxes by 3 %.
 */
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

/* Applies an impulse to b and its opposite to a. */
static inline void rb_constraint_apply(const struct rb_solver_bodies *bodies,
                                       const struct rb_constraint *row, rb_vec3 impulse)
{
	struct rb_solver_body *a = &bodies->body[row->a], *b = &bodies->body[row->b];

	if (row->couple) {
		rb_constraint_couple_apply(bodies, row, impulse);
		return;
	}
	/* non-dynamic bodies may be shared: not written to */
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
 * Returns the only sign that the row's impulse may have: 1 along its normal (contacts, limits), -1
 * against it (ropes, limits of the other side), 0 if both.
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
 * Moves the ends of both arms to the middle between them, where `gap`, m, is b's end relative to
 * a's: an impulse that acts at one point conserves the angular momentum of both.
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

/* Shortens t to the length `max` if it is longer: the cone's cross-section. */
static inline rb_vec3 rb_constraint_within(rb_vec3 t, double max)
{
	const double square = rb_vec3_dot(t, t);

	return square > max * max ? rb_vec3_scale(max / sqrt(square), t) : t;
}

/*
 * Brings an impulse into its set: first the normal component, then the tangential part within the
 * friction that it allows. (For a cone this is not the nearest point; stepped/direct has that.)
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
 * Work that the impulses take from driven bodies (moving, not dynamic), J; such a body is the
 * second of its rows.
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
