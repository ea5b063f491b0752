/* SPDX-License-Identifier: MIT */
/*
 * Motion of bodies between contacts, second half of semi-implicit Euler: positions move with the
 * velocities after forces.
 */
#ifndef RB_STEP_FLOW_H
#define RB_STEP_FLOW_H

#include "step/stage.h"

extern const struct rb_stage rb_stage_translate;
/* For bodies whose spin is constant without torque. */
extern const struct rb_stage rb_stage_rotate;
/*
 * The same for scenes with unequal moments of inertia: angular momentum L is kept, so that w' =
 * I(q)^-1 L before the rotation and w'' = I(q')^-1 L after it. First order, and |L| is exact.
 */
extern const struct rb_stage rb_stage_rotate_gyroscopic;

#endif
