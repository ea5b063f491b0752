/* SPDX-License-Identifier: MIT */
#include "stepped/gauss_seidel.h"

#include <string.h>

#include "base/error.h"
#include "constraint/effective_mass.h"

/*
 * Ratio of the impulses during mixing to the final ones from which on a body's velocity has
 * significant rounding error: ten bits.
 */
static const double digits_lost_ratio = 1024;

/* Like fmax but for NaN, and without a call. */
static inline double larger(double a, double b)
{
	return a > b ? a : b;
}

/* Size of a sweep's changes. */
struct sweep_change {
	double change; /* m/s: largest change of a row's velocity */
	double size;   /* J: sum over all changes of impulses */
};

/* ---- acceleration ---- */

/*
 * Differences between sweeps, of one row: of the changes by sweeps, and of the resulting impulses.
 */
struct rb_sweep_trace {
	rb_vec3 step;            /* N s: change by the present sweep */
	rb_vec3 change, impulse; /* of the last sweep */
	double max;              /* N s: largest impulse set by mixing */
	rb_vec3 change_difference[RB_SWEEP_MEMORY], impulse_difference[RB_SWEEP_MEMORY];
	bool acts; /* has had an impulse: until then only `max` is set and used */
};

/* Solves a contact: normal first, then friction within the cone of the new normal impulse. */
static inline double solve_cone(const struct rb_row_system *dense, struct rb_constraint *row,
                                struct rb_sweep_trace *trace)
{
	const rb_vec3 n = row->normal;
	const rb_vec3 u = rb_constraint_velocity(&dense->bodies, row);
	const double u_n = rb_vec3_dot(u, n);
	/* the sum is clamped, not the change: a later sweep may take back an excess of this one */
	const double unclamped = row->impulse.n + (row->target.n - u_n) / row->inverse_mass_n;
	const double normal_impulse = larger(unclamped, 0);

	/* friction left over by mixing is removed as well */
	if (normal_impulse == 0 && row->impulse.n == 0 && rb_vec3_max_abs(row->impulse.t) == 0) {
		if (trace->acts)
			trace->step = (rb_vec3){0, 0, 0};
		return 0;
	}
	if (!trace->acts)
		*trace = (struct rb_sweep_trace){.acts = true};
	const double delta = normal_impulse - row->impulse.n;
	rb_vec3 change = rb_vec3_scale(delta, n);
	double moved = fabs(delta) * row->inverse_mass_n;

	row->impulse.n = normal_impulse;
	if (row->friction > 0) {
		const rb_vec3 slip = rb_vec3_add_scaled(u, -u_n, n);
		rb_vec3 friction_impulse = rb_vec3_add_scaled(row->impulse.t,
		                                              -1 / row->inverse_mass_t, slip);
		const double square = rb_vec3_dot(friction_impulse, friction_impulse),
			     max = row->friction * normal_impulse;

		if (square > max * max)
			friction_impulse = rb_vec3_scale(max / sqrt(square), friction_impulse);
		const rb_vec3 d = rb_vec3_sub(friction_impulse, row->impulse.t);
		row->impulse.t = friction_impulse;
		change = rb_vec3_add(change, d);
		moved = larger(RB_SLIP_SHARE * row->inverse_mass_t * sqrt(rb_vec3_dot(d, d)),
		               moved);
	}
	RB_ASSERT_COSTLY(row->impulse.n >= 0);
	trace->step = change;
	rb_constraint_apply(&dense->bodies, row, change);
	return moved;
}

/* Step of a FREE row, exact in three directions; `inverse` is that of K. */
static rb_along_across free_step(const struct rb_constraint *row, const rb_mat3 *inverse, rb_vec3 u)
{
	const rb_vec3 off = rb_vec3_sub(rb_constraint_joined(row, row->target), u);

	return rb_constraint_split(row, rb_mat3_apply(inverse, off));
}

static rb_along_across interval_step(const struct rb_constraint *row, rb_vec3 u)
{
	const double residual = row->target.n - rb_vec3_dot(u, row->normal) -
	                        row->softness * row->impulse.n;
	const double unclamped = row->impulse.n + residual / (row->inverse_mass_n + row->softness);

	return (rb_along_across){fmin(fmax(unclamped, row->low), row->high) - row->impulse.n,
	                         {0, 0, 0}};
}

/* Solves a row that is no contact; not inlined, so that the code of contacts is. */
static __attribute__((noinline)) double solve_other(const struct rb_sweep *sweep, int k,
                                                    rb_vec3 *step)
{
	const struct rb_solver_bodies *const bodies = &sweep->dense->bodies;
	struct rb_constraint *const row = &sweep->dense->row[k];
	const rb_vec3 u = rb_constraint_velocity(bodies, row);
	const rb_along_across delta = row->set == RB_CONSTRAINT_FREE
	                                      ? free_step(row, &sweep->inverse[k], u)
	                                      : interval_step(row, u);

	*step = rb_constraint_joined(row, delta);
	row->impulse.n += delta.n;
	row->impulse.t = rb_vec3_add(row->impulse.t, delta.t);
	rb_constraint_apply(bodies, row, *step);
	return fmax(fabs(delta.n) * row->inverse_mass_n,
	            rb_vec3_length(delta.t) * row->inverse_mass_t);
}

/* Solves one row; returns the change of its velocity, m/s. */
static inline double solve_row(const struct rb_sweep *sweep, int k)
{
	struct rb_constraint *const row = &sweep->dense->row[k];

	RB_ASSERT_COSTLY(row->inverse_mass_n > 0 && row->inverse_mass_t > 0);
	if (row->set == RB_CONSTRAINT_CONE)
		return solve_cone(sweep->dense, row, &sweep->trace[k]);
	return solve_other(sweep, k, &sweep->trace[k].step);
}

/* Flattened: calls would cost a tenth of the sweeps. */
static __attribute__((flatten)) struct sweep_change solve_rows(const struct rb_sweep *sweep)
{
	const struct rb_row_system *const dense = sweep->dense;
	struct sweep_change sweep_change = {0, 0};

	for (int k = 0; k < dense->row_count; k++) {
		const struct rb_sweep_trace *const trace = &sweep->trace[k];

		sweep_change.change = larger(solve_row(sweep, k), sweep_change.change);
		if (trace->acts)
			sweep_change.size += dense->row[k].inverse_mass_n *
			                     rb_vec3_dot(trace->step, trace->step);
	}
	return sweep_change;
}

/* Sums over rows, weighted by inverse effective masses. */
struct sums {
	double newest[RB_SWEEP_MEMORY]; /* products of the newest difference with all */
	double now[RB_SWEEP_MEMORY];    /* products of the last change with all */
	/* m^2/s^2: largest square of a row's velocity change by the newest difference */
	double size;
};

/* Stores the last sweep at index `at` of the trace and adds up the sums for mixing. */
static struct sums record_sweep(const struct rb_sweep *sweep, int at, int filled)
{
	struct sums sums = {{0}, {0}, 0};

	for (int k = 0; k < sweep->dense->row_count; k++) {
		const struct rb_constraint *row = &sweep->dense->row[k];
		struct rb_sweep_trace *trace = &sweep->trace[k];

		if (!trace->acts)
			continue;
		const rb_vec3 impulse = rb_constraint_impulse(row);
		const double weight = row->inverse_mass_n;

		trace->change_difference[at] = rb_vec3_sub(trace->step, trace->change);
		trace->impulse_difference[at] = rb_vec3_sub(impulse, trace->impulse);
		trace->change = trace->step;
		trace->impulse = impulse;
		sums.size = larger(sums.size, weight * weight *
		                                      rb_vec3_dot(trace->impulse_difference[at],
		                                                  trace->impulse_difference[at]));
		for (int j = 0; j < filled; j++) {
			const rb_vec3 d = rb_vec3_scale(weight, trace->change_difference[j]);

			sums.newest[j] += rb_vec3_dot(d, trace->change_difference[at]);
			sums.now[j] += rb_vec3_dot(d, trace->step);
		}
	}
	return sums;
}

/* Moves to the mixture of earlier sweeps; the next sweep projects back onto the cones. */
static void apply_mixture(const struct rb_sweep *sweep, const double *mix, int filled)
{
	for (int k = 0; k < sweep->dense->row_count; k++) {
		struct rb_constraint *row = &sweep->dense->row[k];
		struct rb_sweep_trace *trace = &sweep->trace[k];
		rb_vec3 extra = {0, 0, 0};

		if (!trace->acts)
			continue;
		for (int j = 0; j < filled; j++)
			extra = rb_vec3_add_scaled(extra, -mix[j], trace->impulse_difference[j]);
		if (extra.x == 0 && extra.y == 0 && extra.z == 0)
			continue;
		const double normal = rb_vec3_dot(extra, row->normal);
		const bool across = row->friction > 0 || row->set == RB_CONSTRAINT_FREE;
		/* large coefficients would amplify rounding across the normal */
		if (!across)
			extra = rb_vec3_scale(normal, row->normal);
		row->impulse.n += normal;
		if (across)
			row->impulse.t = rb_vec3_add(
				row->impulse.t, rb_vec3_add_scaled(extra, -normal, row->normal));
		rb_constraint_apply(&sweep->dense->bodies, row, extra);
		const rb_vec3 mixed = rb_constraint_impulse(row);
		trace->max = larger(rb_vec3_max_abs(mixed), trace->max);
	}
}

bool rb_sweep_take(struct rb_sweep *sweep, struct rb_arena *arena)
{
	const struct rb_row_system *const dense = sweep->dense;
	const size_t rows = (size_t)dense->row_count;

	sweep->trace = rb_arena_take(arena, rows, sizeof *sweep->trace);
	sweep->inverse = NULL;
	for (int k = 0; !sweep->central && k < dense->row_count && sweep->trace; k++) {
		if (dense->row[k].set != RB_CONSTRAINT_FREE)
			continue;
		if (!sweep->inverse)
			sweep->inverse = rb_arena_take(arena, rows, sizeof *sweep->inverse);
		if (!sweep->inverse)
			return false;
		const rb_mat3 mass = rb_effective_mass_of(&dense->bodies, &dense->row[k],
		                                          rb_effective_mass_world);

		/*
		 * singular only if arms or inertia are not finite, which the check of the step
		 * reports
		 */
		(void)rb_mat3_inverse(&mass, &sweep->inverse[k]);
	}
	return sweep->trace != NULL;
}

/* ---- Anderson mixing ---- */

struct mixture {
	int count, at;                /* differences kept, and the index of the next */
	double size[RB_SWEEP_MEMORY]; /* m/s: largest velocity change of a row by each */
	/*
	 * m/s: bound of velocity changes if each sweep had changed impulses by as much as the first
	 */
	double reach;
	double gram[RB_SWEEP_MEMORY][RB_SWEEP_MEMORY];
};

/*
 * Least squares by factors L D L^T; dependent columns are left out. Without square roots: those of
 * 2x have other digits than those of x, and results are to scale exactly with all masses.
 */
static void solve_gram(const struct mixture *m, int filled, const double *right, double *mix)
{
	double l[RB_SWEEP_MEMORY][RB_SWEEP_MEMORY] = {{0}};
	double d[RB_SWEEP_MEMORY] = {0}, y[RB_SWEEP_MEMORY] = {0};

	RB_ASSERT_COSTLY(filled > 0 && filled <= RB_SWEEP_MEMORY);
	for (int j = 0; j < filled; j++) {
		double pivot = m->gram[j][j];

		for (int k = 0; k < j; k++)
			pivot -= l[j][k] * l[j][k] * d[k];
		if (!(pivot > 1e-10 * m->gram[j][j]))
			continue;
		d[j] = pivot;
		for (int i = j + 1; i < filled; i++) {
			double sum = m->gram[i][j];

			for (int k = 0; k < j; k++)
				sum -= l[i][k] * l[j][k] * d[k];
			l[i][j] = sum / pivot;
		}
	}
	for (int j = 0; j < filled; j++) {
		double sum = right[j];

		for (int k = 0; k < j; k++)
			sum -= l[j][k] * y[k];
		y[j] = d[j] > 0 ? sum : 0;
	}
	for (int j = filled; j-- > 0;) {
		double sum = d[j] > 0 ? y[j] / d[j] : 0;

		for (int k = j + 1; k < filled; k++)
			sum -= l[k][j] * mix[k];
		mix[j] = d[j] > 0 ? sum : 0;
	}
}

/*
 * Whether a mixture moves no row far beyond what sweeps could reach. Where impulses creep, sweeps
 * are nearly alike and give coefficients of any size, whose direction is determined by rounding.
 */
static bool is_within(const struct mixture *m, const double *mix, int filled)
{
	double size = 0;

	for (int j = 0; j < filled; j++)
		size += fabs(mix[j]) * m->size[j];
	/* written so that NaN fails */
	return size <= digits_lost_ratio * m->reach;
}

/*
 * Records the last sweep and moves to the mixture with the least change, unless that is too far;
 * `afresh`: discards all earlier sweeps.
 */
static void accelerate(const struct rb_sweep *sweep, struct mixture *m, bool afresh)
{
	double mix[RB_SWEEP_MEMORY];

	if (afresh) {
		m->count = m->at = 0;
		(void)record_sweep(sweep, 0, 0);
		return;
	}
	RB_ASSERT_COSTLY(m->at >= 0 && m->at < RB_SWEEP_MEMORY);
	const int filled = m->count < RB_SWEEP_MEMORY ? m->count + 1 : RB_SWEEP_MEMORY;
	const struct sums sums = record_sweep(sweep, m->at, filled);
	for (int j = 0; j < filled; j++)
		m->gram[m->at][j] = m->gram[j][m->at] = sums.newest[j];
	m->size[m->at] = sqrt(sums.size);
	solve_gram(m, filled, sums.now, mix);
	m->count = filled;
	m->at = (m->at + 1) % RB_SWEEP_MEMORY;
	if (is_within(m, mix, filled))
		apply_mixture(sweep, mix, filled);
}

/* m/s: largest velocity change of a row by its own impulse. */
static double size_of(const struct rb_sweep *sweep)
{
	double max = 0;

	for (int k = 0; k < sweep->dense->row_count; k++) {
		const struct rb_constraint *row = &sweep->dense->row[k];

		max = larger(max,
		             row->inverse_mass_n * rb_vec3_max_abs(rb_constraint_impulse(row)));
	}
	return max;
}

void rb_sweep_warm(const struct rb_row_system *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (dense->row[k].impulse.n > 0 || dense->row[k].set != RB_CONSTRAINT_CONE)
			rb_constraint_apply(&dense->bodies, &dense->row[k],
			                    rb_constraint_impulse(&dense->row[k]));
}

struct rb_sweep_result rb_sweep_solve(const struct rb_sweep *sweep)
{
	struct rb_sweep_result result = {0};
	struct mixture mixture = {0};
	double before = 0, first = 0;

	RB_ASSERT(sweep->trace && sweep->max > 0 && sweep->tolerance >= 0);
	for (int k = 0; k < sweep->dense->row_count; k++) {
		const struct rb_constraint *const row = &sweep->dense->row[k];

		sweep->trace[k].max = 0;
		sweep->trace[k].acts = row->set != RB_CONSTRAINT_CONE || row->impulse.n != 0 ||
		                       rb_vec3_max_abs(row->impulse.t) != 0;
	}
	while (result.sweeps < sweep->max) {
		const struct sweep_change now = solve_rows(sweep);

		result.sweeps++;
		result.residual = now.change;
		first = result.sweeps == 1 ? now.change : first;
		if (now.change <= sweep->tolerance || result.sweeps == sweep->max ||
		    rb_interrupt_after(sweep->interrupt,
		                       RB_SWEEP_WORK * (uint64_t)sweep->dense->row_count))
			break;
		/*
		 * where it got worse, the active set has changed, and earlier differences are
		 * obsolete
		 */
		mixture.reach += result.sweeps == 1 ? size_of(sweep) : first;
		accelerate(sweep, &mixture, result.sweeps == 1 || now.size > before);
		before = now.size;
	}
	RB_ASSERT(result.sweeps <= sweep->max);
	return result;
}

bool rb_sweep_lost_digits(const struct rb_sweep *sweep, const int *local, double (*impulses)[2],
                          int member_count)
{
	const struct rb_row_system *dense = sweep->dense;
	bool far = false;

	for (int k = 0; k < member_count; k++)
		impulses[k][0] = impulses[k][1] = 0;
	for (int k = 0; k < dense->row_count; k++) {
		const struct rb_constraint *row = &dense->row[k];
		const int ends[2] = {row->a, row->b};

		for (int e = 0; e < 2; e++) {
			const struct rb_solver_body *body = &dense->bodies.body[ends[e]];
			const int at = local[ends[e]];

			if (body->inverse_mass == 0)
				continue;
			RB_ASSERT_COSTLY(at >= 0 && at < member_count);
			if (impulses[at][1] == 0) /* once per body */
				impulses[at][1] = rb_vec3_max_abs(body->linear) /
				                  body->inverse_mass;
			impulses[at][0] += sweep->trace[k].max;
			impulses[at][1] += rb_vec3_max_abs(rb_constraint_impulse(row));
		}
	}
	for (int k = 0; k < member_count; k++)
		far = far || impulses[k][0] > digits_lost_ratio * impulses[k][1];
	return far;
}

double rb_sweep_residual_of(const struct rb_row_system *rows, const struct rb_constraint *row)
{
	const rb_vec3 u = rb_constraint_velocity(&rows->bodies, row);
	const double u_n = rb_vec3_dot(u, row->normal);
	const double normal_impulse = fmax(0, row->impulse.n +
	                                              (row->target.n - u_n) / row->inverse_mass_n);
	const rb_vec3 slip = rb_vec3_add_scaled(u, -u_n, row->normal);
	const rb_vec3 projected = rb_constraint_within(
		rb_vec3_add_scaled(row->impulse.t, -1 / row->inverse_mass_t, slip),
		row->friction * normal_impulse);

	return fmax(fabs(normal_impulse - row->impulse.n) * row->inverse_mass_n,
	            RB_SLIP_SHARE * row->inverse_mass_t *
	                    rb_vec3_length(rb_vec3_sub(projected, row->impulse.t)));
}
