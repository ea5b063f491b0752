/* SPDX-License-Identifier: MIT */
/*
 * Impulses of one group of contacts: strategies from a table, one after the other until one leaves
 * no gap closing by more than the tolerance; then what keeps it from gaining energy, and lets it
 * come to rest.
 *
 *   joints alone?                  -> factors of how they answer each other
 *   at rest as the step began?     -> factors, nothing slips
 *   joints, masses very unequal?   -> factors
 *   else                           -> sweeps to a close aim, then to the tolerance
 *   stalled?                       -> factors; in turns (large); friction held
 *   still not (small)              -> sweeps to their limit
 *                                          |
 *   more energy than before?       -> start over without pushing apart
 *   hardly moves?                  -> solved closely, by sweeps or factors
 *   small?                         -> open impulses made even
 *   gains energy?                  -> less pushing apart, then less of all
 *   nothing moves?                 -> at rest
 *
 * What is at rest is solved by factors as if nothing slipped: sweeps would let towers creep.
 */
#ifndef RB_STEPPED_STRATEGIES_H
#define RB_STEPPED_STRATEGIES_H

#include "stepped/stillness.h"

/* Rows from which on a group is solved by all workers. */
enum { RB_STRATEGY_LARGE_ROWS = 2048 };

/*
 * Impulses of the group's rows and velocities of its bodies, from warm impulses; `residual`,
 * `slip`, `sweeps`, `factors` of the island say how. `residual` is INFINITY where the arena has no
 * room. `team` NULL: on this thread.
 */
void rb_strategies_solve(const struct rb_solver *solver, struct rb_island *island,
                         struct rb_team *team, struct rb_arena *arena);

/*
 * Largest change of velocity that forces make of these bodies in the step, squared, m^2/s^2; the
 * search ends at `tolerance`.
 */
double rb_strategies_external(const struct rb_solver *solver, const int *member, int count,
                              double tolerance);

#endif
