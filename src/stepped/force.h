/* SPDX-License-Identifier: MIT */
/*
 * Forces of a step except contact forces, as changes of velocities.
 *
 * Those of step/force_stages, then force elements and fields with their values at the beginning of
 * the step, then drag, solved at its end. A spring that the step does not resolve is solved at its
 * end too, with all that it connects (stepped/nets): it is stable, but its oscillation is damped.
 * An element of any other kind acts with its value at the beginning of the step.
 */
#ifndef RB_STEPPED_FORCE_H
#define RB_STEPPED_FORCE_H

#include "stepped/stepped_state.h"

RB_CHECKED enum rb_status rb_force_add(struct rb_world *world, const struct rb_cohort *cohort,
                                       double start_s, double h_s, struct rb_error *err);

#endif
