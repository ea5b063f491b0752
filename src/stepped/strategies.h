/* SPDX-License-Identifier: MIT */
/*
 * Impulses of one island: strategies from a table, one after the other until one leaves no gap
 * closing by more than the tolerance; then the passes that prevent energy gain and let the island
 * come to rest.
 *
 *   joints alone?                  -> factors of their Delassus matrix (dual)
 *   at rest as the step began?     -> factors, as if nothing slipped
 *   joints, masses very unequal?   -> factors
 *   else                           -> sweeps to a tight aim, then to the tolerance
 *   stalled?                       -> factors; normals and friction in turns (large);
 *                                     friction held
 *   still not (small)              -> sweeps to their limit
 *                                          |
 *   energy beyond its bounds?      -> start over without separating overlaps
 *   hardly moves?                  -> solved closely, by sweeps or factors
 *   small?                         -> redundant normal impulses of least norm
 *   gains energy?                  -> less separation, then less of all impulses
 *   nothing moves?                 -> at rest
 *
 * An island at rest is solved by factors as if nothing slipped: sweeps would let towers creep.
 */
#ifndef RB_STEPPED_STRATEGIES_H
#define RB_STEPPED_STRATEGIES_H

#include "stepped/stillness.h"

/* Rows from which on an island is solved by all workers. */
enum { RB_STRATEGY_LARGE_ROWS = 2048 };

/*
 * Computes impulses of the island's rows and velocities of its bodies, from warm-start impulses,
 * and sets `residual`, `slip`, `sweeps`, `factors` of the island. `residual` is INFINITY if the
 * arena is full. `team` NULL: on this thread.
 */
void rb_strategies_solve(const struct rb_solver *solver, struct rb_island *island,
                         struct rb_team *team, struct rb_arena *arena);

/*
 * Largest change of velocity of these bodies by forces in the step, squared, m^2/s^2; the search
 * ends at `tolerance`.
 */
double rb_strategies_external(const struct rb_solver *solver, const int *member, int count,
                              double tolerance);

#endif
