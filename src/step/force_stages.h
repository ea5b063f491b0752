/* SPDX-License-Identifier: MIT */
/*
 * Forces except contact forces, which change velocities: one stage each. Contact reactions come
 * after all of them (classic/contact).
 */
#ifndef RB_STEP_FORCE_STAGES_H
#define RB_STEP_FORCE_STAGES_H

#include "step/stage.h"

extern const struct rb_stage rb_stage_gravity;
extern const struct rb_stage rb_stage_gravity_force;
extern const struct rb_stage rb_stage_applied;
extern const struct rb_stage rb_stage_pushes;

/*
 * Effect of a force within a substep: an impulse at the centre of mass, N s, and an angular
 * impulse, N m s.
 */
struct rb_force_impulse {
	rb_vec3 impulse, turn;
	enum rb_ledger_momentum cause;
};
/*
 * Effect of a body's `f`-th force of the scene, at its pose in `state`; zeros while it does not
 * act. And of forces applied by callbacks.
 */
struct rb_force_impulse rb_forces_stated(const struct rb_pass *pass, const struct rb_state *state,
                                         int index, int f);
struct rb_force_impulse rb_forces_pushed(const struct rb_pass *pass, int index);

/*
 * Bound on |acceleration| of the centre of mass by all of these forces at any moment of the step,
 * m/s^2.
 */
double rb_forces_bound(const struct rb_world *world, int index);

#endif
