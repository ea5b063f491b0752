/* SPDX-License-Identifier: MIT */
/* Islands at rest: treatment of their gaps, and detection of coming to rest. */
#ifndef RB_STEPPED_STILLNESS_H
#define RB_STEPPED_STILLNESS_H

#include "stepped/islands.h"

/* Fraction of the tolerance that sweeps may leave of a gap's closing in one step. */
#define RB_STRATEGY_SWEEP_SHARE 0.25
/* The same of islands that are solved closely. */
#define RB_STRATEGY_CLOSE_SHARE 1e-7

/*
 * Rows from which on an island counts as a heap: a stack of it would have more than a hundred
 * boxes.
 */
enum { RB_STRATEGY_HEAP_ROWS = 512 };

/* m/s: an island that is no faster, before the step and after it, is at rest. */
static inline double rb_stillness_speed(const struct rb_solver *solver)
{
	return 16 * RB_STRATEGY_CLOSE_SHARE * solver->tolerance;
}

/*
 * Treats gaps of an island that was at rest as the step began as closed, if they are small or
 * overlaps.
 */
void rb_stillness_skip_gaps(const struct rb_solver *solver, const struct rb_row_system *dense);
/* Sets the velocities of its bodies to zero. */
void rb_stillness_stop(const struct rb_solver *solver, const struct rb_island *island);
/* Marks bodies that are at rest after a solution, and stops them. */
void rb_stillness_find(const struct rb_solver *solver, const struct rb_island *island);

#endif
