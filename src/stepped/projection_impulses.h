/* SPDX-License-Identifier: MIT */
/*
 * Changes of linear momenta by position projection (stepped/projection_energy), as contact
 * impulses, so that the reported forces of a step match the change of each body's momentum. For
 * reports only: no solver reads it.
 *
 * Simulator thread.
 */
#ifndef RB_STEPPED_PROJECTION_IMPULSES_H
#define RB_STEPPED_PROJECTION_IMPULSES_H

#include "stepped/stepped_state.h"

/*
 * `owed`: [bodies] kg m/s, changes of momenta, overwritten. Each body gets its change by the
 * contact of largest impulse that connects it with others, these get the opposite, and so on, up to
 * a body that is not dynamic. A part for which a contact would have to pull, or in a whole step
 * exceed its friction cone, is not reported.
 */
RB_CHECKED enum rb_status rb_projection_impulses(struct rb_world *world, struct rb_cohort *cohort,
                                                 rb_vec3 *owed, struct rb_error *err);

#endif
