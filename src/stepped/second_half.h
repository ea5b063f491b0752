/* SPDX-License-Identifier: MIT */
/*
 * Second half of impulses, at the end of a step: for islands on which only joints and constant
 * forces act (rb_island's `halves`; joint_constraints.h has the scheme).
 *
 *     begin    v(1/2) = v + half of forces, rows such that positions at the end are closed
 *     move     by h v(1/2)
 *     end      v' = v(1/2) + half of forces, rows such that velocities there are consistent
 *
 * Driven bodies then have the velocity of the step's end. Islands that have come to rest in the
 * first half repeat it in the second one, without rows.
 */
#ifndef RB_STEPPED_SECOND_HALF_H
#define RB_STEPPED_SECOND_HALF_H

#include "stepped/islands.h"

/*
 * Makes bodies and rows of all such islands at the end of the step; false: nothing is to be solved.
 */
bool rb_second_half_make(struct rb_solver *solver, const struct rb_world *world);

/* Whether an island has a second half to be solved. */
bool rb_second_half_is_due(const struct rb_solver *solver, const struct rb_island *island);

/* After the solution: adds impulses to those of joints, stores velocities in the world. */
void rb_second_half_end(struct rb_solver *solver, struct rb_world *world);

#endif
