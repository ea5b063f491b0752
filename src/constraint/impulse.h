/* SPDX-License-Identifier: MIT */
/*
 * Impulses of contacts: their effects, and their computation.
 *
 * A link is the mechanics of one contact at one moment: arms, effective masses, materials.
 * Velocities are those of b relative to a at the contact point; an impulse acts on b, its opposite
 * on a. Restitution is Newton's law on the normal velocity, v_n' = -e v_n, where the impact is
 * central or frictionless; for eccentric impacts with friction it is the energetic law (Stronge,
 * Proc. R. Soc. A 431 (1990) 169), which cannot gain energy there.
 */
#ifndef RB_CONSTRAINT_IMPULSE_H
#define RB_CONSTRAINT_IMPULSE_H

#include "step/stage.h"

struct rb_link {
	int a, b;
	rb_vec3 normal;       /* from a to b */
	rb_vec3 arm_a, arm_b; /* m, from the centres of mass to the contact point */
	double friction, restitution;
	/* 1/kg: n.K n, change of normal velocity by a unit normal impulse */
	double normal_inverse_mass;
	double tangent_inverse_mass; /* 1/kg: the largest of t.K t */
	bool central; /* K is diagonal in normal and tangent, and the same for every tangent */
	double inverse_mass_a, inverse_mass_b; /* 1/kg; 0: does not move */
	double inverse_inertia_a,
		inverse_inertia_b;      /* 1/(kg m^2); 0: does not turn, NAN: a tensor */
	rb_mat3 inverse_effective_mass; /* 1/kg: K, filled unless central */
	/* relative error of K, beyond which it may be singular; 0: K is positive */
	double inverse_effective_mass_error;
};

struct rb_link rb_link_of(const struct rb_world *world, const struct rb_state *state,
                          const struct rb_touch *touch, const struct rb_gap *gap);

/* Velocity of b relative to a at the contact point, m/s. */
rb_vec3 rb_link_velocity(const struct rb_world *world, const struct rb_state *state,
                         const struct rb_link *link);

/* Applies an impulse, N s on b. */
void rb_link_apply(struct rb_world *world, const struct rb_link *link, rb_vec3 impulse);

/* Rounding of the relative velocity: a few ulp of the speeds that it is a difference of, m/s. */
double rb_link_noise(const struct rb_world *world, const struct rb_link *link);

/*
 * Returns the impulse on b of a single impact: `velocity` is the relative velocity, approaching;
 * `target_velocity` >= 0 the normal velocity after the impact, whose ratio to the approach is the
 * restitution (for the energetic law).
 */
rb_vec3 rb_link_impact(const struct rb_link *link, rb_vec3 velocity, double target_velocity);

/* One contact among several that are solved together. */
struct rb_impulse_row {
	struct rb_link link;
	double target_velocity; /* m/s: least normal velocity afterwards */
	double normal;          /* N s, >= 0: accumulated impulse */
	rb_vec3 tangent;        /* N s, on b, |tangent| <= friction * normal */

	/* scratch of rb_impulse_rows_solve: impulses as a vector, n times normal plus tangent */
	rb_vec3 change, direction;
};

/*
 * Block Gauss-Seidel with projection: normal velocity at least target_velocity where the normal
 * impulse is zero, equal to it where that is positive; tangential velocity zero inside the friction
 * cone, opposite to the impulse on it. Sweeps are accelerated as nonlinear conjugate gradients
 * (Silcowitz, Niebe, Erleben, "A nonsmooth nonlinear conjugate gradient method for interactive
 * contact force problems", Vis. Comput. 26 (2010) 893), each followed by a plain sweep, so that the
 * result keeps the cone. Rows are in order of pairs; stops when no velocity changes by more than
 * `tolerance`, or after `sweeps`. Accumulated impulses in the rows must have been applied already.
 * Returns the last change, m/s.
 */
double rb_impulse_rows_solve(struct rb_world *world, struct rb_impulse_row *row, int count,
                             int sweeps, double tolerance);

#endif
