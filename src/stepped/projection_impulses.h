/* SPDX-License-Identifier: MIT */
/*
 * What closing overlaps has changed of linear momenta (stepped/projection_energy), as impulses of
 * contacts, so that the forces of a step add up with what it has done to each body. Told only:
 * nothing that is solved reads it.
 *
 * Simulator thread.
 */
#ifndef RB_STEPPED_PROJECTION_IMPULSES_H
#define RB_STEPPED_PROJECTION_IMPULSES_H

#include "stepped/stepped_state.h"

/*
 * `owed`: [bodies] kg m/s, used up. Each body gets it by the contact with the largest impulse of
 * those that join it to the others, these get the opposite, and so on, up to what does not yield.
 * What a contact would have to pull for, or in a whole step could not hold by friction, is told of
 * nobody.
 */
RB_CHECKED enum rb_status rb_projection_impulses(struct rb_world *world, struct rb_cohort *cohort,
                                                 rb_vec3 *owed, struct rb_error *err);

#endif
