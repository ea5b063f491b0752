/* SPDX-License-Identifier: MIT */
#include "stepped/direct.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "stepped/blocks.h"

enum { OUTER_MAX = 30, INNER_MAX = 20, HALVINGS_MAX = 20 };
/* Approximate multiplications per row in a step besides the factorization. */
enum { ROW_WORK = 512 };

/*
 * First penalty weight of a row, times its inverse effective mass; growth factor if multipliers
 * converge slowly, and its limit.
 */
static const double weight_first = 1, weight_first_resting = 30, weight_growth = 10,
		    weight_max = 1e5;
/* For joints, which are always active: chains have far larger effective masses than their rows. */
static const double weight_first_joint = 1e3;
static const double relax_least = 0.3;

/* Solver data of a row. */
struct face {
	rb_vec3 impulse; /* multiplier of the outer iteration */
	rb_vec3 now;     /* projected impulse at the present velocities */
	/*
	 * normal parts of both, for cones: computed from the vectors they would be lost to rounding
	 * beside much larger friction
	 */
	double along, along_now;
	rb_mat3 slope; /* derivative of the projection onto the set */
	double weight; /* kg */
	double shift;  /* m/s: friction times slip */
	bool soft; /* soft row: its weight is 1 / softness throughout, and it has no multiplier */
};

struct newton {
	const struct rb_direct *direct;
	const struct rb_row_system *dense;
	struct face *face;
	struct rb_blocks blocks;
	double *gradient, *step, *scratch; /* [6 members] */
	struct rb_solver_body *kept;       /* [members]: velocities at the start of a line search */
	rb_mat3 *inertia;                  /* [members] */
	double *mass;                      /* [members] */
	double ratio;                      /* of the masses */
	double lever;                      /* m: largest lever of a couple; 0: no couples */
};

static rb_vec3 slip_of(const struct rb_constraint *row, rb_vec3 u)
{
	return rb_vec3_reject(u, row->normal);
}

/* s a b^T added. */
static void add_outer(rb_mat3 *m, double s, rb_vec3 a, rb_vec3 b)
{
	const double x[3] = {a.x, a.y, a.z}, y[3] = {b.x, b.y, b.z};

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			m->m[i][j] += s * x[i] * y[j];
}

/* Nearest point of the friction cone, and the derivative of the projection. */
static void project_cone(const struct rb_constraint *row, struct face *face, rb_vec3 z)
{
	const rb_vec3 n = row->normal;
	const double mu = row->friction;
	const double along = rb_vec3_dot(z, n);
	const rb_vec3 t = rb_vec3_add_scaled(z, -along, n);
	const double across = rb_vec3_length(t);

	RB_ASSERT_COSTLY(mu >= 0);
	face->now = (rb_vec3){0, 0, 0};
	face->along_now = 0;
	face->slope = (rb_mat3){{{0}}};
	if (!(mu > 0)) {
		if (along > 0) {
			face->along_now = along;
			face->now = rb_vec3_scale(along, n);
			add_outer(&face->slope, 1, n, n);
		}
		return;
	}
	if (across <= mu * along) {
		face->now = z;
		face->along_now = along;
		face->slope = rb_mat3_diagonal(1, 1, 1);
		return;
	}
	if (mu * across <= -along)
		return;
	const rb_vec3 tangent = rb_vec3_scale(1 / across, t);
	const rb_vec3 edge = rb_vec3_add_scaled(n, mu, tangent);
	const double normal_impulse = (along + mu * across) / (1 + mu * mu);
	const double side = mu * normal_impulse / across;

	face->now = rb_vec3_scale(normal_impulse, edge);
	face->along_now = normal_impulse;
	face->slope = rb_mat3_diagonal(side, side, side);
	add_outer(&face->slope, -side, n, n);
	add_outer(&face->slope, -side, tangent, tangent);
	add_outer(&face->slope, 1 / (1 + mu * mu), edge, edge);
}

/* Nearest point of the row's set; returns its term of the function, times the weight. */
static inline double project(const struct rb_constraint *row, struct face *face, rb_vec3 z)
{
	const double along = rb_vec3_dot(z, row->normal);

	switch (row->set) {
	case RB_CONSTRAINT_CONE:
		project_cone(row, face, z);
		/* z.now equals now.now for a cone */
		return 0.5 * rb_vec3_dot(face->now, face->now);
	case RB_CONSTRAINT_FREE:
		face->now = z;
		face->slope = rb_mat3_diagonal(1, 1, 1);
		return 0.5 * rb_vec3_dot(z, z);
	case RB_CONSTRAINT_INTERVAL:
		break;
	}
	const double n = fmin(fmax(along, row->low), row->high);

	face->now = rb_vec3_scale(n, row->normal);
	face->slope = (rb_mat3){{{0}}};
	if (along > row->low && along < row->high)
		add_outer(&face->slope, 1, row->normal, row->normal);
	return n * along - 0.5 * n * n;
}

/* ---- the function to be minimized, and its gradient ---- */

static double inertial(const struct newton *s)
{
	double sum = 0;

	for (int k = 0; k < s->direct->member_count; k++) {
		const int i = s->direct->member[k];
		const struct rb_solver_body *b = &s->dense->bodies.body[i],
					    *f = &s->direct->free[i];
		const rb_vec3 v = rb_vec3_sub(b->linear, f->linear);
		const rb_vec3 w = rb_vec3_sub(b->angular, f->angular);
		const rb_vec3 p = rb_vec3_scale(s->mass[k], v);
		const rb_vec3 l = rb_mat3_apply(&s->inertia[k], w);
		double *const g = s->gradient + RB_BLOCK * k;

		rb_vec3_to(g, p);
		rb_vec3_to(g + 3, l);
		sum += 0.5 * (rb_vec3_dot(p, v) + rb_vec3_dot(l, w));
	}
	return sum;
}

static void add_to(double *g, double sign, rb_vec3 force, rb_vec3 torque)
{
	g[0] += sign * force.x;
	g[1] += sign * force.y;
	g[2] += sign * force.z;
	g[3] += sign * torque.x;
	g[4] += sign * torque.y;
	g[5] += sign * torque.z;
}

static rb_vec3 arm_of(const struct newton *s, const struct rb_constraint *row, bool is_a)
{
	const rb_vec3 none = {0, 0, 0};

	if (s->dense->bodies.body[is_a ? row->a : row->b].inverse_inertia == 0)
		return none;
	return is_a ? rb_constraint_arm_a(row) : rb_constraint_arm_b(row);
}

/* Adds the load of a row's impulse on a member to the gradient. */
static inline __attribute__((always_inline)) void add_load(struct newton *s,
                                                           const struct rb_constraint *row,
                                                           bool is_a, rb_vec3 impulse)
{
	const int body = is_a ? row->a : row->b, member = s->direct->local[body];
	const rb_vec3 none = {0, 0, 0};
	double *const g = s->gradient + RB_BLOCK * member;

	if (member < 0)
		return;
	if (!row->couple)
		add_to(g, is_a ? 1 : -1, impulse, rb_vec3_cross(arm_of(s, row, is_a), impulse));
	else if (s->dense->bodies.body[body].inverse_inertia != 0)
		add_to(g, is_a ? 1 : -1, none, rb_vec3_scale(row->arm_a.x, impulse));
}

/* Evaluates faces, gradient, value and its rounding at the bodies' present velocities. */
static double evaluate(struct newton *s, double *rounding)
{
	const struct rb_row_system *dense = s->dense;
	double sum = inertial(s);

	for (int k = 0; k < dense->row_count; k++) {
		const struct rb_constraint *row = &dense->row[k];
		struct face *face = &s->face[k];
		rb_vec3 u = rb_vec3_add_scaled(rb_constraint_velocity(&dense->bodies, row),
		                               face->shift - row->target.n, row->normal);

		RB_ASSERT_COSTLY(face->weight > 0);
		RB_ASSERT_COSTLY(s->direct->local[row->a] < s->direct->member_count &&
		                 s->direct->local[row->b] < s->direct->member_count);
		if (row->set == RB_CONSTRAINT_FREE)
			u = rb_vec3_sub(u, row->target.t);
		if (isinf(row->target.n)) { /* inactive */
			face->now = (rb_vec3){0, 0, 0};
			face->along_now = 0;
			continue;
		}
		sum += project(row, face, rb_vec3_add_scaled(face->impulse, -face->weight, u)) /
		       face->weight;
		add_load(s, row, true, face->now);
		add_load(s, row, false, face->now);
	}
	*rounding = 64 * DBL_EPSILON * fabs(sum);
	return sum;
}

/* ---- one Newton step ---- */

static rb_vec3 row_of(const rb_mat3 *m, int i)
{
	return (rb_vec3){m->m[i][0], m->m[i][1], m->m[i][2]};
}

static rb_vec3 column_of(const rb_mat3 *m, int j)
{
	return (rb_vec3){m->m[0][j], m->m[1][j], m->m[2][j]};
}

/*
 * sign [[K, -K X], [-Y^T K, Y^T K X]] with X, Y the cross matrices of the column's and the row's
 * arm: rows of K X are those of K times that arm, columns of Y^T K the other's cross products.
 */
static void add_block(rb_block *block, double sign, const rb_mat3 *k, rb_vec3 row_arm,
                      rb_vec3 column_arm)
{
	rb_mat3 kx;

	RB_ASSERT_COSTLY(block != NULL);
	for (int i = 0; i < 3; i++) {
		const rb_vec3 across = rb_vec3_cross(row_of(k, i), column_arm);

		kx.m[i][0] = across.x;
		kx.m[i][1] = across.y;
		kx.m[i][2] = across.z;
	}
	for (int j = 0; j < 3; j++) {
		const rb_vec3 yk = rb_vec3_cross(column_of(k, j), row_arm);
		const rb_vec3 ykx = rb_vec3_cross(column_of(&kx, j), row_arm);

		for (int i = 0; i < 3; i++) {
			block->m[i][j] += sign * k->m[i][j];
			block->m[i][j + 3] -= sign * kx.m[i][j];
		}
		block->m[3][j] -= sign * yk.x;
		block->m[4][j] -= sign * yk.y;
		block->m[5][j] -= sign * yk.z;
		block->m[3][j + 3] += sign * ykx.x;
		block->m[4][j + 3] += sign * ykx.y;
		block->m[5][j + 3] += sign * ykx.z;
	}
}

/* The same for a couple, which acts on rotation only. */
static void add_couple(rb_block *block, double sign, const rb_mat3 *k, double lever)
{
	RB_ASSERT_COSTLY(block != NULL);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			block->m[i + 3][j + 3] += sign * lever * lever * k->m[i][j];
}

/* Index of a member in the system; -1: none, or a couple's body that cannot rotate. */
static int member_of(const struct newton *s, const struct rb_constraint *row, int body)
{
	return row->couple && s->dense->bodies.body[body].inverse_inertia == 0
	               ? -1
	               : s->direct->local[body];
}

static void assemble_row(struct newton *s, const struct rb_constraint *row, const rb_mat3 *weighted)
{
	const int a = member_of(s, row, row->a), b = member_of(s, row, row->b);
	const rb_vec3 arm_a = arm_of(s, row, true), arm_b = arm_of(s, row, false);
	const double lever = row->arm_a.x;
	bool transposed;

	for (int e = 0; e < 2; e++) {
		const int i = e ? b : a;
		const rb_vec3 arm = e ? arm_b : arm_a;

		if (i >= 0 && row->couple)
			add_couple(rb_blocks_at(&s->blocks, i, i, &transposed), 1, weighted, lever);
		else if (i >= 0)
			add_block(rb_blocks_at(&s->blocks, i, i, &transposed), 1, weighted, arm,
			          arm);
	}
	if (a < 0 || b < 0)
		return;
	rb_block *both = rb_blocks_at(&s->blocks, a, b, &transposed);
	if (row->couple)
		add_couple(both, -1, weighted, lever);
	else
		add_block(both, -1, weighted, transposed ? arm_b : arm_a,
		          transposed ? arm_a : arm_b);
}

static void assemble(struct newton *s)
{
	bool transposed;

	rb_blocks_clear(&s->blocks);
	for (int k = 0; k < s->direct->member_count; k++) {
		rb_block *block = rb_blocks_at(&s->blocks, k, k, &transposed);

		for (int i = 0; i < 3; i++) {
			block->m[i][i] += s->mass[k];
			for (int j = 0; j < 3; j++)
				block->m[i + 3][j + 3] += s->inertia[k].m[i][j];
		}
	}
	for (int k = 0; k < s->dense->row_count; k++) {
		const struct rb_constraint *row = &s->dense->row[k];
		const struct face *face = &s->face[k];
		rb_mat3 weighted = face->slope;

		if (row->set == RB_CONSTRAINT_CONE && rb_vec3_dot(face->now, face->now) == 0)
			continue;
		for (int i = 0; i < 9; i++)
			weighted.m[i / 3][i % 3] *= face->weight;
		assemble_row(s, row, &weighted);
	}
}

/* Moves velocities from the start of the line search by a fraction of the step. */
static void move_by(struct newton *s, double share)
{
	for (int k = 0; k < s->direct->member_count; k++) {
		struct rb_solver_body *body = &s->dense->bodies.body[s->direct->member[k]];
		const double *step = s->step + RB_BLOCK * k;

		body->linear = rb_vec3_add_scaled(s->kept[k].linear, share, rb_vec3_from(step));
		if (body->inverse_inertia != 0)
			body->angular = rb_vec3_add_scaled(s->kept[k].angular, share,
			                                   rb_vec3_from(step + 3));
	}
}

/* Largest change of velocity corresponding to the gradient, m/s. */
static double imbalance(const struct newton *s)
{
	double max = 0;

	for (int k = 0; k < s->direct->member_count; k++) {
		const double *const g = s->gradient + RB_BLOCK * k;

		max = fmax(max, rb_vec3_max_abs(rb_vec3_from(g)) / s->mass[k]);
		if (s->lever > 0)
			max = fmax(max, s->lever * rb_vec3_max_abs(rb_solver_turn(
							   &s->dense->bodies, s->direct->member[k],
							   rb_vec3_from(g + 3))));
	}
	return max;
}

/* One Newton step with line search. False: no more improvement. */
static bool newton_step(struct newton *s, double *value, double *rounding)
{
	const int n = RB_BLOCK * s->direct->member_count;
	double slope = 0, share = 1;

	assemble(s);
	if (!rb_blocks_factor(&s->blocks))
		return false;
	for (int i = 0; i < n; i++)
		s->step[i] = -s->gradient[i];
	rb_blocks_solve(&s->blocks, s->step, s->scratch);
	for (int i = 0; i < n; i++)
		slope += s->step[i] * s->gradient[i];
	for (int k = 0; k < s->direct->member_count; k++)
		s->kept[k] = s->dense->bodies.body[s->direct->member[k]];
	for (int halving = 0; halving < HALVINGS_MAX; halving++, share *= 0.5) {
		move_by(s, share);
		const double new_value = evaluate(s, rounding);

		if (new_value <= *value + 1e-4 * share * slope + *rounding) {
			*value = new_value;
			return true;
		}
	}
	move_by(s, 0);
	*value = evaluate(s, rounding);
	return false;
}

/* Residuals, m/s: of contacts; of joints; of the cones' shifts. */
struct residuals {
	double contacts, joints, shifts;
};

/* Updates the multipliers to the projected impulses. */
static struct residuals update_multipliers(struct newton *s, double relax)
{
	struct residuals residual = {0};

	for (int k = 0; k < s->dense->row_count; k++) {
		const struct rb_constraint *row = &s->dense->row[k];
		struct face *face = &s->face[k];
		const rb_vec3 d = rb_vec3_sub(face->now, face->impulse);

		if (face->soft)
			continue;
		double *const max = row->set == RB_CONSTRAINT_CONE ? &residual.contacts
		                                                   : &residual.joints;
		*max = fmax(*max, sqrt(rb_vec3_dot(d, d)) / face->weight);
		face->impulse = face->now;
		face->along = face->along_now;
		if (row->friction > 0) {
			const rb_vec3 u = rb_constraint_velocity(&s->dense->bodies, row);
			const double shift = row->friction * rb_vec3_length(slip_of(row, u));
			/* closing velocity that reducing an excessive shift would give */
			const double closes = row->target.n - rb_vec3_dot(u, row->normal);
			const double change = fabs(shift - face->shift);
			const bool is_active = rb_vec3_dot(face->now, face->now) > 0;

			residual.shifts = fmax(residual.shifts,
			                       is_active ? change : fmin(change, closes));
			if (relax > 0) {
				const double mean = sqrt(shift) * sqrt(face->shift);

				face->shift += relax * (shift - face->shift);
				/* it may be wrong by orders of magnitude */
				if (!is_active && closes > 0)
					face->shift = fmin(face->shift, mean);
			}
		}
	}
	return residual;
}

/* ---- driver ---- */

/* The plan first: large islands are rejected by it, before memory is taken for the rest. */
static bool prepare(struct newton *s)
{
	const struct rb_direct *direct = s->direct;
	const struct rb_row_system *dense = s->dense;
	const size_t n = (size_t)direct->member_count, rows = (size_t)dense->row_count;
	int(*pair)[2] = rb_arena_take(direct->arena, rows, sizeof *pair);
	int pairs = 0;

	if (!pair)
		return false;
	for (size_t k = 0; k < n; k++)
		direct->local[direct->member[k]] = (int)k;
	for (size_t k = 0; k < rows; k++) {
		const int a = direct->local[dense->row[k].a], b = direct->local[dense->row[k].b];

		if (a >= 0 && b >= 0) {
			pair[pairs][0] = a;
			pair[pairs++][1] = b;
		}
	}
	if (!rb_blocks_plan(&s->blocks, (int)n, (const int(*)[2])pair, pairs, direct->max,
	                    direct->arena))
		return false;
	s->face = rb_arena_take(direct->arena, rows, sizeof *s->face);
	s->gradient = rb_arena_take(direct->arena, 3 * RB_BLOCK * n, sizeof *s->gradient);
	s->kept = rb_arena_take(direct->arena, n, sizeof *s->kept);
	s->inertia = rb_arena_take(direct->arena, n, sizeof *s->inertia);
	s->mass = rb_arena_take(direct->arena, n, sizeof *s->mass);
	if (!s->face || !s->gradient || !s->kept || !s->inertia || !s->mass)
		return false;
	s->step = s->gradient + RB_BLOCK * n;
	s->scratch = s->step + RB_BLOCK * n;
	return true;
}

/*
 * First weight of contacts, times their inverse effective masses. Joints increase effective masses.
 */
static double first_weight(const struct newton *s)
{
	return s->direct->holds || !rb_row_system_is_of_contacts(s->dense) ? weight_first_resting
	                                                                   : weight_first;
}

static void fill(struct newton *s)
{
	const struct rb_row_system *dense = s->dense;
	double lightest = (double)INFINITY, heaviest = 0;

	for (int k = 0; k < s->direct->member_count; k++) {
		const int i = s->direct->member[k];
		const struct rb_solver_body *b = &dense->bodies.body[i];
		const double turn = b->inverse_inertia != 0 ? 1 / b->inverse_inertia
		                                            : 1 / b->inverse_mass;

		RB_ASSERT_COSTLY(b->inverse_mass > 0);
		s->mass[k] = 1 / b->inverse_mass;
		lightest = fmin(lightest, s->mass[k]);
		heaviest = fmax(heaviest, s->mass[k]);
		if (isnan(b->inverse_inertia))
			(void)rb_mat3_inverse(&dense->bodies.tensor[i], &s->inertia[k]);
		else
			s->inertia[k] = rb_mat3_diagonal(turn, turn, turn);
	}
	s->ratio = heaviest / lightest;
	RB_ASSERT(s->ratio >= 1);
	const double first = first_weight(s);
	for (int k = 0; k < dense->row_count; k++) {
		const struct rb_constraint *row = &dense->row[k];
		const double slip = rb_vec3_length(
			slip_of(row, rb_constraint_velocity(&dense->bodies, row)));

		if (row->couple)
			s->lever = fmax(s->lever, row->arm_a.x);
		s->face[k] = (struct face){
			.impulse = rb_constraint_impulse(row),
			.along = row->impulse.n,
			.weight = (row->set == RB_CONSTRAINT_CONE ? first : weight_first_joint) /
		                  row->inverse_mass_n,
			.shift = s->direct->holds ? 0 : row->friction * slip};
		if (row->softness > 0)
			s->face[k] = (struct face){.weight = 1 / row->softness, .soft = true};
	}
}

/* Velocity error due to rounding of the impulses, m/s: no residual can be smaller. */
static double noise_of(const struct newton *s)
{
	double max = 0;

	for (int k = 0; k < s->dense->row_count; k++)
		max = fmax(max, s->dense->row[k].inverse_mass_n * rb_vec3_max_abs(s->face[k].now));
	return RB_DIRECT_NOISE_ULP * DBL_EPSILON * max;
}

static struct rb_direct_result solve(struct newton *s)
{
	struct rb_direct_result result = {.tried = true};
	double before = (double)INFINITY, shifted = (double)INFINITY, grown = 1;
	double relax = s->direct->holds ? 0 : 1;
	const bool joined = !rb_row_system_is_of_contacts(s->dense);
	const uint64_t rows = (uint64_t)s->dense->row_count;

	for (int outer = 0; outer < OUTER_MAX && result.steps < s->direct->steps_max &&
	                    !rb_interrupt_is_set(s->direct->interrupt);
	     outer++) {
		double rounding, value = evaluate(s, &rounding);
		double tolerance = fmax(s->direct->tolerance, noise_of(s));

		for (int inner = 0; inner < INNER_MAX && result.steps < s->direct->steps_max &&
		                    imbalance(s) > 0.1 * tolerance;
		     inner++) {
			const double from = value, was = imbalance(s);

			result.steps++;
			if (!newton_step(s, &value, &rounding) ||
			    rb_interrupt_after(s->direct->interrupt,
			                       (uint64_t)s->blocks.work + ROW_WORK * rows))
				break;
			/* with weights of joints rounding may exceed the tolerance */
			if (joined && from - value <= rounding && imbalance(s) > 0.5 * was)
				break;
			tolerance = fmax(s->direct->tolerance, noise_of(s));
		}
		const double balance = imbalance(s);
		const struct residuals residual = update_multipliers(s, relax);

		/* largest residual as a multiple of its tolerance */
		const double excess = fmax(residual.contacts / tolerance,
		                           residual.joints /
		                                   fmax(s->direct->joint_tolerance, tolerance));

		result.residual = fmax(fmax(balance, residual.shifts),
		                       fmax(residual.contacts, residual.joints));
		if (balance <= tolerance && excess <= 1 &&
		    residual.shifts <= s->direct->slip_tolerance)
			break;
		if (s->direct->steps_few > 0 && result.steps >= s->direct->steps_few &&
		    result.residual <= s->direct->acceptable)
			break;
		if (excess > 1 && excess > 0.1 * before && grown < weight_max * s->ratio) {
			grown *= weight_growth;
			for (int k = 0; k < s->dense->row_count; k++)
				if (!s->face[k].soft)
					s->face[k].weight *= weight_growth;
		}
		/* a contact assumed to stick slips after all */
		if (relax == 0 &&
		    fmax(residual.contacts, residual.joints) <= s->direct->slip_tolerance &&
		    residual.shifts > s->direct->slip_tolerance)
			relax = 1;
		/* the iteration of the shifts may oscillate */
		else if (relax > 0 && residual.shifts > 0.9 * shifted)
			relax = fmax(relax_least, 0.6 * relax);
		before = excess;
		shifted = residual.shifts;
	}
	return result;
}

/* Impulse of a row after the outer iteration, within its set. */
static rb_along_across impulse_of(const struct rb_constraint *row, const struct face *face)
{
	const rb_vec3 impulse = face->soft ? face->now : face->impulse;
	const double n = rb_vec3_dot(impulse, row->normal);
	const rb_vec3 none = {0, 0, 0};

	if (row->set == RB_CONSTRAINT_FREE)
		return rb_constraint_split(row, impulse);
	if (row->set == RB_CONSTRAINT_INTERVAL)
		return (rb_along_across){fmin(fmax(n, row->low), row->high), none};
	const rb_vec3 across = row->friction > 0 ? rb_vec3_reject(impulse, row->normal) : none;
	return (rb_along_across){face->along,
	                         rb_constraint_within(across, row->friction * face->along)};
}

struct rb_direct_result rb_direct_solve(const struct rb_direct *direct)
{
	struct rb_direct_result result = {.tried = false};
	struct newton s = {.direct = direct, .dense = direct->dense};
	const rb_arena_mark here = rb_arena_here(direct->arena);

	RB_ASSERT(direct->steps_max > 0 && direct->tolerance > 0 && direct->slip_tolerance > 0);
	if (direct->member_count > 0 && prepare(&s)) {
		fill(&s);
		result = solve(&s);
		for (int k = 0; k < direct->dense->row_count; k++) {
			struct rb_constraint *row = &direct->dense->row[k];

			row->impulse = impulse_of(row, &s.face[k]);
		}
		RB_ASSERT(result.steps <= direct->steps_max);
		/* recompute velocities from the impulses */
		for (int k = 0; k < direct->member_count; k++)
			direct->dense->bodies.body[direct->member[k]] =
				direct->free[direct->member[k]];
		for (int k = 0; k < direct->dense->row_count; k++)
			rb_constraint_apply(&direct->dense->bodies, &direct->dense->row[k],
			                    rb_constraint_impulse(&direct->dense->row[k]));
	}
	rb_arena_back(direct->arena, here);
	return result;
}
