/* SPDX-License-Identifier: MIT */
/*
 * How bodies give way where a constraint holds them: K, with du = K p for an impulse p on b and its
 * opposite on a.
 *
 *     at arms   K = (1/m_a + 1/m_b) 1 - [r_a] I_a^-1 [r_a] - [r_b] I_b^-1 [r_b]
 *     couple    K = l^2 (I_a^-1 + I_b^-1)
 *
 * [r] the matrix of r x. Each body's part is symmetric and not negative. Pure functions.
 */
#ifndef RB_CONSTRAINT_EFFECTIVE_MASS_H
#define RB_CONSTRAINT_EFFECTIVE_MASS_H

#include "constraint/row.h"

/* Axes of the world. */
extern const rb_vec3 rb_effective_mass_world[3];

/*
 * Adds to k, in these orthogonal unit axes, what one body at that arm gives way by, 1/kg: `spin[c]`
 * is what the angular impulse arm x axis[c] does to its spin. For who has bodies of another form.
 */
void rb_effective_mass_add_spins(double inverse_mass, rb_vec3 arm, const rb_vec3 axis[3],
                                 const rb_vec3 spin[3], rb_mat3 *k);

/* The same of body i. In axes normal, x, y the first entry is n.K n. */
void rb_effective_mass_add(const struct rb_solver_bodies *bodies, int i, rb_vec3 arm,
                           const rb_vec3 axis[3], rb_mat3 *k);

/* The larger eigenvalue of the block of the last two axes: how far K goes across the first. */
static inline double rb_effective_mass_across(const rb_mat3 *k)
{
	return 0.5 * (k->m[1][1] + k->m[2][2]) + hypot(0.5 * (k->m[1][1] - k->m[2][2]), k->m[1][2]);
}

/* The same of K in world axes, across a unit normal. */
double rb_effective_mass_tangent(const rb_mat3 *k, rb_vec3 normal);

/* 1/kg: n.K n of one body alone, by its lever, the arm x n. */
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
