/* SPDX-License-Identifier: MIT */
#include "stepped/stillness.h"

#include <float.h>

#include "stepped/direct.h"

/* Of the tolerance, gaps and overlaps that count as closed: of what stands, beside touches. */
static const double let_share = 1.0 / 32, touch_share = 0.5;

/* What holds both ways, or has friction, and has drifted by no more. */
static bool is_closed(const struct rb_constraint *row, double max)
{
	return row->softness == 0 && rb_vec3_length(rb_constraint_joined(row, row->target)) <= max;
}

/*
 * The end of the rows of the pair that begins with row k; sets whether some contact of it bore
 * something in the step before.
 */
static int end_of_pair(const struct rb_row_system *dense, int k, bool *bears)
{
	const struct rb_constraint *first = &dense->row[k];

	*bears = false;
	for (; k < dense->row_count; k++) {
		const struct rb_constraint *row = &dense->row[k];

		if (row->a != first->a || row->b != first->b)
			break;
		*bears = *bears || (row->set == RB_CONSTRAINT_CONE && row->impulse.n > 0);
	}
	return k;
}

/*
 * Gaps far below the tolerance count as closed where bodies stand: then standing still is among
 * what is possible, however they are wedged. So do all overlaps: what stands has nothing to push
 * apart with. And all gaps within half of the tolerance beside a contact that bears: faces of a
 * stack that lie on each other to within the tolerance only would rock on the corners that touch,
 * slowly and for ever, and the tilts of all bodies add up at the top.
 */
void rb_stillness_skip_gaps(const struct rb_solver *solver, const struct rb_row_system *dense)
{
	const double whole = solver->tolerance / RB_STRATEGY_SWEEP_SHARE;
	double max = 0;

	for (int k = 0, end = 0; k < dense->row_count; k++) {
		struct rb_constraint *row = &dense->row[k];
		const int side = rb_constraint_side(row);
		bool bears;

		if (k == end) {
			end = end_of_pair(dense, k, &bears);
			max = (bears ? touch_share : let_share) * whole;
		}

		if (side != 0 ? side * row->target.n >= -max : is_closed(row, max))
			row->target = (rb_along_across){0, {0, 0, 0}};
	}
}

void rb_stillness_stop(const struct rb_solver *solver, const struct rb_island *island)
{
	for (int k = 0; k < island->member_count; k++) {
		struct rb_solver_body *body =
			&solver->dense.bodies.body[solver->member[island->first_member + k]];

		body->linear = body->angular = (rb_vec3){0, 0, 0};
	}
}

/*
 * m/s: what rounding of impulses makes of velocities at the top of a tower of so many bodies, as
 * errors of what stands on each other add up. Heaps are not that high.
 */
static double rounding_speed(const struct rb_solver *solver, const struct rb_island *island)
{
	const struct rb_row_system rows = rb_islands_rows(solver, island);
	const double levers = (double)island->member_count * (double)island->member_count;
	double max = 0;

	if (rows.row_count >= RB_STRATEGY_HEAP_ROWS)
		return 0;
	for (int k = 0; k < rows.row_count; k++)
		max = fmax(max, rows.row[k].inverse_mass_n * rows.row[k].impulse.n);
	return levers * RB_DIRECT_NOISE_ULP * DBL_EPSILON * max;
}

/*
 * Solved closely, before the step and after it no faster than what solving closely leaves, or what
 * rounding does: it stands still. At the former speed a body would take two million steps for the
 * tolerance.
 */
void rb_stillness_find(const struct rb_solver *solver, const struct rb_island *island)
{
	const double least = rb_stillness_speed(solver), close = least / 16;
	const double each = 1 / rb_islands_lasts(solver, island);
	bool rests = solver->before && island->residual <= close && !island->carried;
	const double rest_speed = rests ? fmax(least, rounding_speed(solver, island)) : least;

	for (int k = 0; rests && k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];
		const struct rb_solver_body *body = &solver->dense.bodies.body[i];
		const double reach = solver->reach[i];
		const size_t at = 3 * (size_t)i;

		rests = rb_vec3_max_abs(body->linear) <= rest_speed &&
		        rb_vec3_max_abs(body->angular) * reach <= rest_speed &&
		        rb_vec3_max_abs(rb_vec3_from(solver->before->velocity + at)) <=
		                rest_speed &&
		        (!solver->before->spin ||
		         rb_vec3_max_abs(rb_vec3_from(solver->before->spin + at)) * reach <=
		                 rest_speed);
	}
	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		solver->rests[i] = rests;
		rb_vec3_to(solver->rest_external + 6 * (size_t)i,
		           rb_vec3_scale(each, solver->free[i].linear));
		rb_vec3_to(solver->rest_external + 6 * (size_t)i + 3,
		           rb_vec3_scale(each, solver->free[i].angular));
	}
	if (rests)
		rb_stillness_stop(solver, island);
}
