/* SPDX-License-Identifier: MIT */
/*
 * Driven bodies in a step: from pose to pose of their function.
 *
 * While contacts are solved they move at the constant velocity and spin that lead from one pose to
 * the other, so that no gap closes at the step's end; what they then have is the function's own
 * velocity where it gives one, else that mean.
 */
#ifndef RB_STEPPED_DRIVEN_BODIES_H
#define RB_STEPPED_DRIVEN_BODIES_H

#include "stepped/stepped_state.h"

/*
 * Their rows hold the pose at start_s, in the state; velocities of state and mark become those of
 * the step.
 */
RB_CHECKED enum rb_status rb_drive_begin(struct rb_world *world, double start_s, double h_s,
                                         struct rb_error *err);
/* To the pose at the end. */
void rb_drive_end(struct rb_world *world);

#endif
