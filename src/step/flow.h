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
 * The same for scenes with unequal moments of inertia: without torque, kinetic energy and angular
 * momentum are kept to rounding for any step (rb_top_step).
 */
extern const struct rb_stage rb_stage_rotate_gyroscopic;

/*
 * Rotation of a body in `h` seconds from the present orientation and this spin, rad, with the
 * gyroscopic change of the spin: of second order in h.
 */
rb_vec3 rb_flow_turn(const struct rb_world *world, int i, double h, rb_vec3 spin);

#endif
