/* SPDX-License-Identifier: MIT */
#include "constraint/effective_mass.h"

#include "base/error.h"

const rb_vec3 rb_effective_mass_world[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

void rb_effective_mass_add_spins(double inverse_mass, rb_vec3 arm, const rb_vec3 axis[3],
                                 const rb_vec3 spin[3], rb_mat3 *k)
{
	for (int c = 0; c < 3; c++) {
		const rb_vec3 turn = rb_vec3_cross(spin[c], arm);

		for (int r = 0; r < 3; r++)
			k->m[r][c] += rb_vec3_dot(axis[r], turn) + (r == c ? inverse_mass : 0);
	}
}

void rb_effective_mass_add(const struct rb_solver_bodies *bodies, int i, rb_vec3 arm,
                           const rb_vec3 axis[3], rb_mat3 *k)
{
	const struct rb_solver_body *const body = &bodies->body[i];
	rb_vec3 spin[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};

	for (int c = 0; c < 3 && body->inverse_inertia != 0; c++)
		spin[c] = rb_solver_turn(bodies, i, rb_vec3_cross(arm, axis[c]));
	rb_effective_mass_add_spins(body->inverse_mass, arm, axis, spin, k);
}

double rb_effective_mass_tangent(const rb_mat3 *k, rb_vec3 normal)
{
	const rb_vec3 t = rb_vec3_across(normal), s = rb_vec3_cross(normal, t);
	const rb_vec3 kt = rb_mat3_apply(k, t), ks = rb_mat3_apply(k, s);
	const double tt = rb_vec3_dot(t, kt), ss = rb_vec3_dot(s, ks), ts = rb_vec3_dot(s, kt);

	return 0.5 * (tt + ss) + hypot(0.5 * (tt - ss), ts);
}

/* Adds a body's part of K for a couple. */
static void add_couple(const struct rb_solver_bodies *bodies, int i, double lever,
                       const rb_vec3 axis[3], rb_mat3 *k)
{
	if (bodies->body[i].inverse_inertia == 0)
		return;
	for (int c = 0; c < 3; c++) {
		const rb_vec3 turn = rb_solver_turn(bodies, i, axis[c]);

		for (int r = 0; r < 3; r++)
			k->m[r][c] += lever * lever * rb_vec3_dot(axis[r], turn);
	}
}

rb_mat3 rb_effective_mass_of(const struct rb_solver_bodies *bodies, const struct rb_constraint *row,
                             const rb_vec3 axis[3])
{
	rb_mat3 k = {{{0}}};

	if (row->couple) {
		add_couple(bodies, row->a, row->arm_a.x, axis, &k);
		add_couple(bodies, row->b, row->arm_a.x, axis, &k);
		return k;
	}
	rb_effective_mass_add(bodies, row->a, rb_constraint_arm_a(row), axis, &k);
	rb_effective_mass_add(bodies, row->b, rb_constraint_arm_b(row), axis, &k);
	return k;
}

/* Entries of K that solvers use: normal, and tangential. */
struct entries {
	double nn, xx, yy, xy;
};

static void add_entries(const struct rb_solver_bodies *bodies, int i, rb_vec3 arm,
                        const rb_vec3 axis[3], struct entries *k)
{
	const struct rb_solver_body *const body = &bodies->body[i];
	rb_vec3 lever[3], spin[3];

	k->nn += body->inverse_mass;
	k->xx += body->inverse_mass;
	k->yy += body->inverse_mass;
	if (body->inverse_inertia == 0)
		return;
	for (int c = 0; c < 3; c++) {
		lever[c] = rb_vec3_cross(arm, axis[c]);
		spin[c] = rb_solver_turn(bodies, i, lever[c]);
	}
	k->nn += rb_vec3_dot(lever[0], spin[0]);
	k->xx += rb_vec3_dot(lever[1], spin[1]);
	k->yy += rb_vec3_dot(lever[2], spin[2]);
	k->xy += rb_vec3_dot(lever[1], spin[2]);
}

/*
 * Isotropic inertias: the rotational part of K is J (r^2 1 - r r^T), which along n is J |n x r|^2,
 * and tangentially J (r.n)^2 in every direction plus J |n x r|^2 in the direction of n x r.
 */
static void fill_isotropic(const struct rb_solver_bodies *bodies, struct rb_constraint *row)
{
	const struct rb_solver_body *a = &bodies->body[row->a], *b = &bodies->body[row->b];
	const rb_vec3 n = row->normal;
	const rb_vec3 p = rb_vec3_cross(n, row->arm_a), q = rb_vec3_cross(n, row->arm_b);
	const double along_a = rb_vec3_dot(n, row->arm_a), along_b = rb_vec3_dot(n, row->arm_b);
	const double masses = a->inverse_mass + b->inverse_mass;
	const double pp = a->inverse_inertia * rb_vec3_dot(p, p);
	const double qq = b->inverse_inertia * rb_vec3_dot(q, q), pq = rb_vec3_dot(p, q);
	const double isotropic = masses + a->inverse_inertia * along_a * along_a +
	                         b->inverse_inertia * along_b * along_b;
	const double off = pp - qq;

	row->inverse_mass_n = masses + pp + qq;
	/* the larger eigenvalue of J_a p p^T + J_b q q^T */
	row->inverse_mass_t = isotropic +
	                      0.5 * (pp + qq +
	                             sqrt(off * off +
	                                  4 * a->inverse_inertia * b->inverse_inertia * pq * pq));
}

void rb_effective_mass_fill(const struct rb_solver_bodies *bodies, struct rb_constraint *row)
{
	const struct rb_solver_body *a = &bodies->body[row->a], *b = &bodies->body[row->b];

	if (row->central) {
		row->inverse_mass_n = a->inverse_mass + b->inverse_mass;
		row->inverse_mass_t = row->inverse_mass_n +
		                      a->inverse_inertia * row->arm_a.x * row->arm_a.x +
		                      b->inverse_inertia * row->arm_b.x * row->arm_b.x;
		return;
	}
	if (!row->couple && !isnan(a->inverse_inertia) && !isnan(b->inverse_inertia)) {
		fill_isotropic(bodies, row);
		return;
	}
	const rb_vec3 x = rb_vec3_across(row->normal);
	const rb_vec3 axis[3] = {row->normal, x, rb_vec3_cross(row->normal, x)};
	if (row->couple) {
		const rb_mat3 k = rb_effective_mass_of(bodies, row, axis);

		row->inverse_mass_n = k.m[0][0];
		row->inverse_mass_t = rb_effective_mass_across(&k);
		return;
	}
	struct entries k = {0};

	add_entries(bodies, row->a, rb_constraint_arm_a(row), axis, &k);
	add_entries(bodies, row->b, rb_constraint_arm_b(row), axis, &k);
	RB_ASSERT_COSTLY(k.nn > 0);
	/*
	 * the larger eigenvalue of the tangential block, as in rb_effective_mass_across, but
	 * without hypot
	 */
	const double half = 0.5 * (k.xx - k.yy);
	row->inverse_mass_n = k.nn;
	row->inverse_mass_t = 0.5 * (k.xx + k.yy) + sqrt(half * half + k.xy * k.xy);
}
