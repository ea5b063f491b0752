/* SPDX-License-Identifier: MIT */
/*
 * The second half of impulses, at the end of a step: of groups that nothing but joints and constant
 * forces acts on (rb_island's `halves`; joint_constraints.h has the scheme).
 *
 *     begin    v(1/2) = v + half of forces, rows such that positions at the end close
 *     move     by h v(1/2)
 *     end      v' = v(1/2) + half of forces, rows such that velocities there close
 *
 * Driven bodies have then the velocity of the step's end. Groups that have come to rest in the
 * first half do the same in the second one, and are not asked about.
 */
#ifndef RB_STEPPED_SECOND_HALF_H
#define RB_STEPPED_SECOND_HALF_H

#include "stepped/islands.h"

/* Bodies and rows of all such groups as they stand at the end; false: nothing is to be solved. */
bool rb_second_half_make(struct rb_solver *solver, const struct rb_world *world);

/* Whether a group has one. */
bool rb_second_half_is_due(const struct rb_solver *solver, const struct rb_island *island);

/* It is solved: impulses are added to those of joints, velocities go to the world. */
void rb_second_half_end(struct rb_solver *solver, struct rb_world *world);

#endif
