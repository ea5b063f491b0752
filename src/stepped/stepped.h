/* SPDX-License-Identifier: MIT */
/*
 * The stepped method: equal steps, for groups with too many events to locate one by one.
 *
 * Equations. With positions x, velocities v, masses M, the step h, forces f, and for each contact
 * point the rows J (normal and two tangents), the bias b and the impulse p:
 *
 *     v' = v + M^-1 (h f + J^T p)                 velocities at the end of the step
 *     u  = J v' + b                               normal: the gap at the end of the step, over h
 *     0 <= p_n  perpendicular to  u_n >= 0        Signorini: no gap is closed at the end
 *     |p_t| <= mu p_n, p_t against u_t            Coulomb
 *     x' = x + h v'                               positions move with the solved velocities
 *
 * Impacts have the law of constraint/simultaneous, resolved in order of time within the step where
 * the group is small. Iterations end when the residual closes no gap by more than a share of the
 * tolerance (stepped/strategies).
 *
 * One attempt of a step; stepped.c has the loop of attempts and halvings:
 *
 *     velocities after forces --> candidate pairs --> contact points, warm-start impulses
 *      (force, nets)               (candidates)        (contact_points)
 *                                                          |
 *       impacts within the step, in order of time <--------+     (flight, impact_pass)
 *                       |
 *       islands of contacts, joints, springs that share a dynamic body      (islands)
 *                       |
 *       each: still at rest? --> no rows                              (islands_rest)
 *             joints alone? --> reduced coordinates                (reduced_islands)
 *             else strategies from a table, until one is accepted       (strategies)
 *                       |
 *       move bodies                                                        (attempt)
 *                       |
 *       overlap or drift by rotation beyond what projection may close?
 *                       |no            |yes: contact points and rows from the poses at
 *                       |              |the end, solve again, up to 6 times  (relinearize)
 *       impacts left to the end of the step rebound  (solve, joined_rebound)
 *                       |
 *       verdict: finite, residual, drift, thrown?                            (judge)
 *                       |
 *       close overlaps by moving positions; its energy is paid by spin
 *                       |                      (projection, projection_energy)
 *       overlap within the tolerance? --yes--> commit: contacts, events, ledger
 *                       |no                     (contact_records, step_ledger)
 *       back; the bodies concerned take half the step               (local_rollback)
 *
 * Constants are at the top of the file that uses them, each with the case that it comes from:
 * sweeps, factors and their budgets in strategies.c (the sphere heap, the box heap and the mass
 * ratios of `tests/bench`, `rbsim verify` stack and arch); weights of Newton's method in direct.c;
 * limits of position projection in projection.c; the cost of one impact in impact_pass.c (a break
 * of 136 balls); overrelaxation in wide.c (the sphere heap).
 */
#ifndef RB_STEPPED_STEPPED_H
#define RB_STEPPED_STEPPED_H

#include "model/descriptor.h"
#include "world/world.h"

struct rb_stepped;

void rb_stepped_destroy(struct rb_stepped *stepped); /* NULL is fine */

/*
 * Memory for bodies once they lie in a heap, beyond that at the start, bytes: storage per contact
 * and per pair, while impulses are being solved.
 */
size_t rb_stepped_heap_bytes(const struct rb_model *model, int threads);

/* After another method, the first step starts from the contact forces that this has left. */
extern const struct rb_stepper rb_stepper_stepped;

#endif
