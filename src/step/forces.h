/* SPDX-License-Identifier: MIT */
/* What changes velocities other than contact: one stage each. Reactions come after all of them (step/contact). */
#ifndef RB_STEP_FORCES_H
#define RB_STEP_FORCES_H

#include "step/stage.h"

extern const struct rb_stage rb_stage_gravity;
extern const struct rb_stage rb_stage_gravity_force;
extern const struct rb_stage rb_stage_applied;
extern const struct rb_stage rb_stage_pushes;

/* Bound on |acceleration| of the centre of mass by all of these forces at any moment of the step, m/s^2. */
double rb_forces_bound(const struct rb_world *world, int index);

#endif
