/* SPDX-License-Identifier: MIT */
/* Islands that stay at rest as in the step before, on the same contacts. */
#include "stepped/islands.h"

#include <string.h>

#include "base/error.h"

/* Whether the vector of a body is zero (a missing column counts as zero). */
static bool is_zero(const double *column, int i)
{
	const double *v = column ? column + 3 * (size_t)i : NULL;

	return !v || (v[0] == 0 && v[1] == 0 && v[2] == 0);
}

/*
 * Whether all members were at rest in the last step and have the same external accelerations, and
 * nothing driven moves at them.
 */
static bool is_at_rest(const struct rb_solver *solver, const struct rb_island *island)
{
	for (int k = 0; k < island->member_count; k++) {
		const int i = solver->member[island->first_member + k];

		if (!solver->before || !is_zero(solver->before->velocity, i) ||
		    !is_zero(solver->before->spin, i) ||
		    !rb_rest_holds(solver, i, &solver->free[i].linear.x, &solver->free[i].angular.x,
		                   solver->h_s))
			return false;
	}
	return !island->is_driven;
}

/* Number of contacts of the island that had a force in the step before. */
static size_t bearing_count(const struct rb_solver *solver, const struct rb_step_points *points,
                            const struct rb_island *island)
{
	size_t count = 0;

	for (int m = 0; m < island->member_count && points->last_count > 0; m++) {
		const int i = solver->member[island->first_member + m];

		for (size_t k = points->first_last[i]; k < points->first_last[i + 1]; k++)
			count += points->last[k].force > 0;
	}
	return count;
}

/*
 * An island at rest keeps the contact forces of the step that brought it to rest. A step of another
 * length searches a smaller range, and may miss one of several points of a face: the forces would
 * differ then.
 */
void rb_islands_rest(struct rb_solver *solver, const struct rb_step_points *points,
                     const int *group_of, struct rb_arena *arena)
{
	const rb_arena_mark here = rb_arena_here(arena);
	bool any = false;

	for (size_t g = 0; g < solver->island_count; g++) {
		solver->island[g].rests = is_at_rest(solver, &solver->island[g]);
		any = any || solver->island[g].rests;
	}
	if (!any)
		return;
	size_t *const found = rb_arena_take(arena, solver->island_count, sizeof *found);
	unsigned char *const seen = rb_arena_take(arena, points->last_count + 1, 1);
	if (found && seen) {
		memset(found, 0, solver->island_count * sizeof *found);
		memset(seen, 0, points->last_count + 1);
	}
	for (size_t k = 0; found && seen && k < points->count; k++) {
		const uint32_t from = points->row[k].from;

		if (from > 0 && points->last[from - 1].force > 0) {
			found[group_of[k]] += !seen[from];
			seen[from] = 1;
		}
	}
	for (size_t g = 0; g < solver->island_count; g++) {
		struct rb_island *const island = &solver->island[g];

		/* without memory no island stays at rest */
		island->rests = island->rests && found && seen &&
		                found[g] == bearing_count(solver, points, island);
	}
	rb_arena_back(arena, here);
}
