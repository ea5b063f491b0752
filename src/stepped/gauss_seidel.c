/* SPDX-License-Identifier: MIT */
#include "stepped/gauss_seidel.h"

#include <string.h>

#include "base/error.h"

/*
 * Bodies that mixtures have pushed so many times as hard as it came to have some rounding of their
 * own: ten bits.
 */
static const double far_ratio = 1024;

/* What a sweep has come to. */
struct share {
	double change; /* m/s: the largest of a row's velocity */
	double size;   /* J: of all changes of impulses */
};

/*
 * One row on its own. Normal first, then friction within the cone that the new normal impulse
 * allows.
 */
static inline double solve_row(const struct rb_row_system *dense, struct rb_system_row *row)
{
	RB_ASSERT_COSTLY(row->inverse_mass_n > 0 && row->inverse_mass_t > 0);
	const rb_vec3 n = row->normal;
	const rb_vec3 u = rb_system_velocity(dense, row);
	const double u_n = rb_vec3_dot(u, n);
	/*
	 * the sum is clamped, not the change: a later sweep may take back what this one gives too
	 * much
	 */
	const double push = fmax(0, row->push + (row->target_velocity - u_n) / row->inverse_mass_n);

	/* what a mixture has left across the normal goes as well */
	if (push == 0 && row->push == 0 && rb_vec3_max_abs(row->friction_impulse) == 0) {
		row->step = (rb_vec3){0, 0, 0};
		return 0;
	}
	const double more = push - row->push;
	rb_vec3 change = rb_vec3_scale(more, n);
	double moved = fabs(more) * row->inverse_mass_n;

	row->push = push;
	if (row->friction > 0) {
		const rb_vec3 slip = rb_vec3_add_scaled(u, -u_n, n);
		rb_vec3 friction_impulse = rb_vec3_add_scaled(row->friction_impulse,
		                                              -1 / row->inverse_mass_t, slip);
		const double square = rb_vec3_dot(friction_impulse, friction_impulse),
			     max = row->friction * push;

		if (square > max * max)
			friction_impulse = rb_vec3_scale(max / sqrt(square), friction_impulse);
		const rb_vec3 d = rb_vec3_sub(friction_impulse, row->friction_impulse);
		row->friction_impulse = friction_impulse;
		change = rb_vec3_add(change, d);
		moved = fmax(moved, RB_SLIP_SHARE * row->inverse_mass_t * sqrt(rb_vec3_dot(d, d)));
	}
	RB_ASSERT_COSTLY(row->push >= 0);
	row->step = change;
	rb_system_apply(dense, row, change);
	return moved;
}

static struct share solve_rows(const struct rb_row_system *dense)
{
	struct share share = {0, 0};

	for (int k = 0; k < dense->row_count; k++) {
		struct rb_system_row *row = &dense->row[k];

		share.change = fmax(share.change, solve_row(dense, row));
		share.size += row->inverse_mass_n * rb_vec3_dot(row->step, row->step);
	}
	return share;
}

/* ---- acceleration ---- */

/* Differences between sweeps, of one row: of what each changed, and of what each led to. */
struct rb_sweep_trace {
	rb_vec3 change, impulse; /* of the last sweep */
	double max;              /* N s: the largest impulse that it was led to */
	rb_vec3 more_change[RB_SWEEP_MEMORY], more_impulse[RB_SWEEP_MEMORY];
};

/* Sums over rows, weighted by their yields. */
struct sums {
	double newest[RB_SWEEP_MEMORY]; /* of the newest difference with all */
	double now[RB_SWEEP_MEMORY];    /* of the last change with all */
};

/* Puts the last sweep into place `at` of the trace and adds up what the mixture needs. */
static struct sums remember_rows(const struct rb_sweep *sweep, int at, int filled)
{
	struct sums sums = {{0}, {0}};

	for (int k = 0; k < sweep->dense->row_count; k++) {
		const struct rb_system_row *row = &sweep->dense->row[k];
		struct rb_sweep_trace *trace = &sweep->trace[k];
		const rb_vec3 impulse = rb_system_impulse(row);
		const double weight = row->inverse_mass_n;

		trace->more_change[at] = rb_vec3_sub(row->step, trace->change);
		trace->more_impulse[at] = rb_vec3_sub(impulse, trace->impulse);
		trace->change = row->step;
		trace->impulse = impulse;
		for (int j = 0; j < filled; j++) {
			const rb_vec3 d = rb_vec3_scale(weight, trace->more_change[j]);

			sums.newest[j] += rb_vec3_dot(d, trace->more_change[at]);
			sums.now[j] += rb_vec3_dot(d, row->step);
		}
	}
	return sums;
}

/* Goes to the mixture of earlier sweeps; the sweep that comes next projects back onto the cone. */
static void follow_rows(const struct rb_sweep *sweep, const double *mix, int filled)
{
	for (int k = 0; k < sweep->dense->row_count; k++) {
		struct rb_system_row *row = &sweep->dense->row[k];
		const struct rb_sweep_trace *trace = &sweep->trace[k];
		rb_vec3 extra = {0, 0, 0};

		for (int j = 0; j < filled; j++)
			extra = rb_vec3_add_scaled(extra, -mix[j], trace->more_impulse[j]);
		if (extra.x == 0 && extra.y == 0 && extra.z == 0)
			continue;
		const double normal = rb_vec3_dot(extra, row->normal);
		/* large mixtures make much of what rounding is across the normal */
		if (row->friction == 0)
			extra = rb_vec3_scale(normal, row->normal);
		row->push += normal;
		if (row->friction > 0)
			row->friction_impulse = rb_vec3_add(
				row->friction_impulse,
				rb_vec3_add_scaled(extra, -normal, row->normal));
		rb_system_apply(sweep->dense, row, extra);
		const rb_vec3 led = rb_system_impulse(row);
		sweep->trace[k].max = fmax(sweep->trace[k].max, rb_vec3_max_abs(led));
	}
}

bool rb_sweep_take(struct rb_sweep *sweep, struct rb_arena *arena)
{
	sweep->trace = rb_arena_take(arena, (size_t)sweep->dense->row_count, sizeof *sweep->trace);
	return sweep->trace != NULL;
}

/* ---- Anderson's mixture ---- */

struct mixture {
	int count, at; /* differences that are kept, and the place of the next */
	double gram[RB_SWEEP_MEMORY][RB_SWEEP_MEMORY];
};

/* Least squares by Cholesky; what depends on the others is left out. */
static void solve_gram(const struct mixture *m, int filled, const double *right, double *mix)
{
	double l[RB_SWEEP_MEMORY][RB_SWEEP_MEMORY] = {{0}};
	double y[RB_SWEEP_MEMORY] = {0};

	RB_ASSERT_COSTLY(filled > 0 && filled <= RB_SWEEP_MEMORY);
	for (int j = 0; j < filled; j++) {
		double pivot = m->gram[j][j];

		for (int k = 0; k < j; k++)
			pivot -= l[j][k] * l[j][k];
		if (!(pivot > 1e-10 * m->gram[j][j]))
			continue;
		l[j][j] = sqrt(pivot);
		for (int i = j + 1; i < filled; i++) {
			double sum = m->gram[i][j];

			for (int k = 0; k < j; k++)
				sum -= l[i][k] * l[j][k];
			l[i][j] = sum / l[j][j];
		}
	}
	for (int j = 0; j < filled; j++) {
		double sum = right[j];

		for (int k = 0; k < j; k++)
			sum -= l[j][k] * y[k];
		y[j] = l[j][j] > 0 ? sum / l[j][j] : 0;
	}
	for (int j = filled; j-- > 0;) {
		double sum = y[j];

		for (int k = j + 1; k < filled; k++)
			sum -= l[k][j] * mix[k];
		mix[j] = l[j][j] > 0 ? sum / l[j][j] : 0;
	}
}

/*
 * Takes the last sweep in and goes to the mixture that would have changed least; `afresh`: forgets
 * all before.
 */
static void accelerate(const struct rb_sweep *sweep, struct mixture *m, bool afresh)
{
	double mix[RB_SWEEP_MEMORY];

	if (afresh) {
		m->count = m->at = 0;
		(void)remember_rows(sweep, 0, 0);
		return;
	}
	RB_ASSERT_COSTLY(m->at >= 0 && m->at < RB_SWEEP_MEMORY);
	const int filled = m->count < RB_SWEEP_MEMORY ? m->count + 1 : RB_SWEEP_MEMORY;
	const struct sums sums = remember_rows(sweep, m->at, filled);
	for (int j = 0; j < filled; j++)
		m->gram[m->at][j] = m->gram[j][m->at] = sums.newest[j];
	solve_gram(m, filled, sums.now, mix);
	m->count = filled;
	m->at = (m->at + 1) % RB_SWEEP_MEMORY;
	follow_rows(sweep, mix, filled);
}

void rb_sweep_warm(const struct rb_row_system *dense)
{
	for (int k = 0; k < dense->row_count; k++)
		if (dense->row[k].push > 0)
			rb_system_apply(dense, &dense->row[k], rb_system_impulse(&dense->row[k]));
}

struct rb_sweep_result rb_sweep_solve(const struct rb_sweep *sweep)
{
	struct rb_sweep_result result = {0};
	struct mixture mixture = {0};
	double before = 0;

	RB_ASSERT(sweep->trace && sweep->max > 0 && sweep->tolerance >= 0);
	for (int k = 0; k < sweep->dense->row_count; k++)
		sweep->trace[k].max = 0;
	while (result.sweeps < sweep->max) {
		const struct share now = solve_rows(sweep->dense);

		result.sweeps++;
		result.residual = now.change;
		if (now.change <= sweep->tolerance || result.sweeps == sweep->max)
			break;
		/* where it got worse, faces have changed, and with them what was learned */
		accelerate(sweep, &mixture, result.sweeps == 1 || now.size > before);
		before = now.size;
	}
	RB_ASSERT(result.sweeps <= sweep->max);
	return result;
}

bool rb_sweep_went_far(const struct rb_sweep *sweep, const int *local, double (*push)[2],
                       int member_count)
{
	const struct rb_row_system *dense = sweep->dense;
	bool far = false;

	for (int k = 0; k < member_count; k++)
		push[k][0] = push[k][1] = 0;
	for (int k = 0; k < dense->row_count; k++) {
		const struct rb_system_row *row = &dense->row[k];
		const int ends[2] = {row->a, row->b};

		for (int e = 0; e < 2; e++) {
			const struct rb_solver_body *body = &dense->body[ends[e]];
			const int at = local[ends[e]];

			if (body->inverse_mass == 0)
				continue;
			RB_ASSERT_COSTLY(at >= 0 && at < member_count);
			if (push[at][1] == 0) /* once a body */
				push[at][1] = rb_vec3_max_abs(body->linear) / body->inverse_mass;
			push[at][0] += sweep->trace[k].max;
			push[at][1] += rb_vec3_max_abs(rb_system_impulse(row));
		}
	}
	for (int k = 0; k < member_count; k++)
		far = far || push[k][0] > far_ratio * push[k][1];
	return far;
}
