/* SPDX-License-Identifier: MIT */
/*
 * Groups that stand still: what their gaps count as, and when they have come to rest.
 */
#ifndef RB_STEPPED_STILLNESS_H
#define RB_STEPPED_STILLNESS_H

#include "stepped/islands.h"

/* Of the tolerance, what sweeps may leave of a gap's closing in one step. */
#define RB_STRATEGY_SWEEP_SHARE 0.25
/* The same of groups that are solved closely. */
#define RB_STRATEGY_CLOSE_SHARE 1e-7

/* Rows from which on a group is a heap: it would be a stack of a hundred boxes and more. */
enum { RB_STRATEGY_HEAP_ROWS = 512 };

/* m/s: a group that is no faster, before the step and after it, is at rest. */
static inline double rb_stillness_speed(const struct rb_solver *solver)
{
	return 16 * RB_STRATEGY_CLOSE_SHARE * solver->tolerance;
}

/* Gaps of a group that was at rest as the step began: small ones, and overlaps, count as closed. */
void rb_stillness_skip_gaps(const struct rb_solver *solver, const struct rb_row_system *dense);
/* Its bodies have no velocity. */
void rb_stillness_stop(const struct rb_solver *solver, const struct rb_island *island);
/* Sets who rests after a solution, and stops them. */
void rb_stillness_find(const struct rb_solver *solver, const struct rb_island *island);

#endif
