/* SPDX-License-Identifier: MIT */
/*
 * The inverse effective mass K at a constraint: du = K p for an impulse p on b and its opposite on
 * a.
 *
 *     at arms   K = (1/m_a + 1/m_b) 1 - [r_a] I_a^-1 [r_a] - [r_b] I_b^-1 [r_b]
 *     couple    K = l^2 (I_a^-1 + I_b^-1)
 *
 * [r] is the matrix of r x. Each body's part is symmetric and positive semidefinite. Pure
 * functions.
 */
#ifndef RB_CONSTRAINT_EFFECTIVE_MASS_H
#define RB_CONSTRAINT_EFFECTIVE_MASS_H

#include "constraint/row.h"

/* Axes of the world. */
extern const rb_vec3 rb_effective_mass_world[3];

/*
 * Adds to k the part of a body at an arm, in these orthogonal unit axes, 1/kg; `spin[c]` is the
 * change of its spin by the angular impulse arm x axis[c]. For callers with other representations
 * of bodies.
 */
void rb_effective_mass_add_spins(double inverse_mass, rb_vec3 arm, const rb_vec3 axis[3],
                                 const rb_vec3 spin[3], rb_mat3 *k);

/* The same for body i. In axes normal, x, y the first entry is n.K n. */
void rb_effective_mass_add(const struct rb_solver_bodies *bodies, int i, rb_vec3 arm,
                           const rb_vec3 axis[3], rb_mat3 *k);

/* The larger eigenvalue of the block of the last two axes: the tangential bound of K. */
static inline double rb_effective_mass_across(const rb_mat3 *k)
{
	return 0.5 * (k->m[1][1] + k->m[2][2]) + hypot(0.5 * (k->m[1][1] - k->m[2][2]), k->m[1][2]);
}

/* The same for K in world axes, tangential to a unit normal. */
double rb_effective_mass_tangent(const rb_mat3 *k, rb_vec3 normal);

/* One body's part of n.K n, 1/kg; its lever is arm x n. */
static inline double rb_effective_mass_along(const struct rb_solver_bodies *bodies, int i,
                                             rb_vec3 lever)
{
	return bodies->body[i].inverse_mass + rb_vec3_dot(lever, rb_solver_turn(bodies, i, lever));
}

/* K of both bodies of a row, in these axes. */
rb_mat3 rb_effective_mass_of(const struct rb_solver_bodies *bodies, const struct rb_constraint *row,
                             const rb_vec3 axis[3]);

/* Sets inverse_mass_n and inverse_mass_t. */
void rb_effective_mass_fill(const struct rb_solver_bodies *bodies, struct rb_constraint *row);

#endif
