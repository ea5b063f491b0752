/* SPDX-License-Identifier: MIT */
/*
 * Driven (kinematic) bodies in a step: from pose to pose of their function.
 *
 * While contacts are solved they move with the constant velocity and spin that lead from one pose
 * to the other, so that no gap closes at the step's end; afterwards they have the function's own
 * velocity where it states one, else an extrapolation.
 */
#ifndef RB_STEPPED_DRIVEN_BODIES_H
#define RB_STEPPED_DRIVEN_BODIES_H

#include "stepped/stepped_state.h"

/*
 * Requires their pose at start_s in the state; sets their velocities in state and mark to those of
 * the step.
 */
RB_CHECKED enum rb_status rb_drive_begin(struct rb_world *world, double start_s, double h_s,
                                         struct rb_error *err);
/* Moves them to the pose at the end. */
void rb_drive_end(struct rb_world *world);

#endif
