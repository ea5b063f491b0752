/* SPDX-License-Identifier: MIT */
/*
 * Impacts within a step, by the law of constraint/simultaneous.
 *
 * An impact is an approach that does not come from the forces of the step. In order of time, each
 * is resolved together with all that touches then, as long as these are no more than
 * RB_IMPACT_CONTACTS; bodies go on from there. What lasts is solved afterwards for the whole step.
 * Larger groups rebound when the step is over, at once (rb_solver_rebound), and are counted; joined
 * bodies do so then by the law (stepped/joined_rebound).
 *
 * Impacts that give nothing back are such ones where something else does, or where the step's
 * solution would take them apart (rb_flight_splits) and no more than two bodies that yield touch.
 */
#ifndef RB_STEPPED_IMPACT_PASS_H
#define RB_STEPPED_IMPACT_PASS_H

#include "stepped/stepped_state.h"

RB_CHECKED enum rb_status rb_impacts_create(struct rb_stepped *stepped,
                                            const struct rb_model *model, struct rb_error *err);
void rb_impacts_release(struct rb_stepped *stepped);

/*
 * The points are known, bodies stand at the beginning of the step and have the velocities that its
 * forces make. Impacts are added to these and to the cohort's hits; points get the gaps that are
 * left to the step's solution.
 */
RB_CHECKED enum rb_status rb_impacts_resolve(struct rb_world *world, struct rb_cohort *cohort,
                                             double start_s, double h_s, struct rb_error *err);

/* The approach of a point that was found later becomes that after the impacts. */
void rb_impacts_seen(const struct rb_stepped *stepped, struct rb_step_point *point);

/* rad/s: what impacts have added to a body's. */
static inline rb_vec3 rb_impacts_spin(const struct rb_stepped *stepped, int i)
{
	return stepped->kicks.count > 0 ? rb_kick_of(&stepped->kicks, i)->angular
	                                : (rb_vec3){0, 0, 0};
}

/* A body that impacts have moved goes the way that it has gone before them. */
static inline void rb_impacts_shift(const struct rb_stepped *stepped, struct rb_state *state, int i)
{
	double *const x = state->position + 3 * (size_t)i;

	if (rb_kicks_have(&stepped->kicks, i))
		rb_vec3_to(x, rb_vec3_add(rb_vec3_from(x), rb_kick_of(&stepped->kicks, i)->shift));
}

#endif
