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
 * the group is small. Impulses are found until what is left closes no gap by more than a share of
 * the tolerance (stepped/strategies).
 *
 * One step:
 *
 *     stage of forces ---> candidate pairs ---> contact points, warm impulses
 *      (force)              (candidates)         (contact_points)
 *                                                     |
 *       impacts of the step before, in order of time <+   (flight, impact_pass)
 *                       |
 *       groups of points that share a dynamic body        (islands)
 *                       |
 *       each: joints alone? by what they leave free       (swing)
 *       else: strategies from a table, until one is good  (strategies: drawing there)
 *                       |
 *       move; impacts left for the end rebound            (attempt)
 *                       |
 *       overlap of what turns? --small--> close by moving positions (projection, lift)
 *                       |large
 *       solve again with the points of now, once          (attempt)
 *                       |
 *       verdict: finite, overlap within the tolerance? --yes--> commit: contacts, events, ledger
 *                       |no                                     (contact_records, enter)
 *       back; the bodies concerned take half the step     (local_rollback)
 *
 * Constants stand at the top of the file that uses them, each with the case that it comes from:
 * sweeps, factors and their budgets in strategies.c (the sphere heap, the box heap and the mass
 * ratios of `tests/bench`, `rbsim verify` stack and arch); weights of Newton's method in direct.c;
 * what closing may move in projection.c; the work of one impact in impact_pass.c (a break of 136
 * balls); overrelaxation in wide.c (the sphere heap).
 */
#ifndef RB_STEPPED_STEPPED_H
#define RB_STEPPED_STEPPED_H

#include "model/descriptor.h"
#include "world/world.h"

struct rb_stepped;

void rb_stepped_destroy(struct rb_stepped *stepped); /* NULL is fine */

/*
 * Bytes of bodies that come to lie in a heap, beyond what they have from the start: what is there
 * by contact and by pair, while impulses are solved for.
 */
size_t rb_stepped_heap_bytes(const struct rb_model *model, int threads);

/*
 * Taking over after another method starts from the forces of the contacts that this has left.
 */
extern const struct rb_stepper rb_stepper_stepped;

#endif
