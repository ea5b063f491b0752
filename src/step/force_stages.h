/* SPDX-License-Identifier: MIT */
/*
 * What changes velocities other than contact: one stage each. Reactions come after all of them
 * (classic/contact).
 */
#ifndef RB_STEP_FORCE_STAGES_H
#define RB_STEP_FORCE_STAGES_H

#include "step/stage.h"

extern const struct rb_stage rb_stage_gravity;
extern const struct rb_stage rb_stage_gravity_force;
extern const struct rb_stage rb_stage_applied;
extern const struct rb_stage rb_stage_pushes;

/*
 * What a force does within the substep: an impulse at the centre of mass, N s, and a turn, N m s.
 */
struct rb_force_impulse {
	rb_vec3 impulse, turn;
	enum rb_ledger_momentum cause;
};
/*
 * Of a body's `f`-th stated force, at its pose of `state`; zeros while it does not act. Of what
 * callbacks push with.
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
