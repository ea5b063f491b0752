/* SPDX-License-Identifier: MIT */
#include "stepped/stillness.h"

#include <float.h>

#include "stepped/direct.h"

/*
 * Gaps and overlaps that count as closed in an island at rest, as fractions of the tolerance: in
 * general, and beside a loaded contact of the same pair.
 */
static const double gap_share = 1.0 / 32, loaded_pair_share = 0.5;

/* Whether a bilateral row or friction has drifted by no more than `max`. */
static bool is_closed(const struct rb_constraint *row, double max)
{
	return row->softness == 0 && rb_vec3_length(rb_constraint_joined(row, row->target)) <= max;
}

/*
 * End of the rows of the pair that begins with row k; sets whether a contact of it had an impulse
 * in the step before.
 */
static int end_of_pair(const struct rb_row_system *dense, int k, bool *is_loaded)
{
	const struct rb_constraint *first = &dense->row[k];

	*is_loaded = false;
	for (; k < dense->row_count; k++) {
		const struct rb_constraint *row = &dense->row[k];

		if (row->a != first->a || row->b != first->b)
			break;
		*is_loaded = *is_loaded || (row->set == RB_CONSTRAINT_CONE && row->impulse.n > 0);
	}
	return k;
}

/*
 * Gaps far below the tolerance count as closed in an island at rest: then zero velocity is a
 * feasible solution, however the bodies are wedged. So do all overlaps: a body at rest has no
 * energy to separate them. And all gaps within half of the tolerance beside a loaded contact: faces
 * of a stack that are flush only to within the tolerance would rock on the corners that touch,
 * slowly and for ever, and the tilts of all bodies add up at the top.
 */
void rb_stillness_skip_gaps(const struct rb_solver *solver, const struct rb_row_system *dense)
{
	const double whole = solver->tolerance / RB_STRATEGY_SWEEP_SHARE;
	double max = 0;

	for (int k = 0, end = 0; k < dense->row_count; k++) {
		struct rb_constraint *row = &dense->row[k];
		const int side = rb_constraint_side(row);
		bool is_loaded;

		if (k == end) {
			end = end_of_pair(dense, k, &is_loaded);
			max = (is_loaded ? loaded_pair_share : gap_share) * whole;
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
 * m/s: velocity error due to rounding of impulses at the top of a tower of so many bodies, as
 * errors in a stack add up. Heaps are not that high.
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
 * An island is at rest if it is solved closely, and is before the step and after it no faster than
 * the residual of a close solution, or than rounding. At the former speed a body would need two
 * million steps to move by the tolerance.
 */
void rb_stillness_find(const struct rb_solver *solver, const struct rb_island *island)
{
	const double least = rb_stillness_speed(solver), close = least / 16;
	const double each = 1 / rb_islands_impulse_time(solver, island);
	bool rests = solver->before && island->residual <= close && !island->is_driven;
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
