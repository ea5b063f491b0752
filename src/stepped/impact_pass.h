/* SPDX-License-Identifier: MIT */
/*
 * Impacts within a step, by the law of constraint/simultaneous.
 *
 * An impact is an approach that the forces of the step have not made. In order of time, each is
 * resolved together with all contacts that touch then, up to RB_IMPACT_CONTACTS; bodies continue
 * from there. Lasting contact is solved afterwards for the whole step. Larger groups rebound
 * together at the end of the step (rb_solver_rebound), and are counted; so do jointed bodies, by
 * the law (stepped/joined_rebound).
 *
 * Impacts without restitution are resolved here if other contacts have restitution, or if the
 * step's solution would separate them (rb_flight_splits) and no more than two dynamic bodies touch.
 */
#ifndef RB_STEPPED_IMPACT_PASS_H
#define RB_STEPPED_IMPACT_PASS_H

#include "stepped/stepped_state.h"

RB_CHECKED enum rb_status rb_impacts_create(struct rb_stepped *stepped,
                                            const struct rb_model *model, struct rb_error *err);
void rb_impacts_release(struct rb_stepped *stepped);

/*
 * Requires contact points, positions of the beginning of the step and velocities with its forces.
 * Changes these velocities, and appends to the cohort's impacts; points get the gaps that remain
 * for the step's solution.
 */
RB_CHECKED enum rb_status rb_impacts_resolve(struct rb_world *world, struct rb_cohort *cohort,
                                             double start_s, double h_s, struct rb_error *err);

/* Adds the impacts' changes of velocity to the approach of a point that was found later. */
void rb_impacts_update_approach(const struct rb_stepped *stepped, struct rb_step_point *point);

/* Change of a body's spin by impacts, rad/s. */
static inline rb_vec3 rb_impacts_spin(const struct rb_stepped *stepped, int i)
{
	return stepped->kicks.count > 0 ? rb_kick_of(&stepped->kicks, i)->angular
	                                : (rb_vec3){0, 0, 0};
}

/*
 * Adds the displacement by which a body's path before impacts differs from that at its final
 * velocity.
 */
static inline void rb_impacts_shift(const struct rb_stepped *stepped, struct rb_state *state, int i)
{
	double *const x = state->position + 3 * (size_t)i;

	if (rb_kicks_have(&stepped->kicks, i))
		rb_vec3_to(x, rb_vec3_add(rb_vec3_from(x), rb_kick_of(&stepped->kicks, i)->shift));
}

#endif
