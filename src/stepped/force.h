/* SPDX-License-Identifier: MIT */
/*
 * Forces of a step apart from contact, as changes of velocities.
 *
 * Those of step/force_stages, then force elements and fields, whose values are those of the step's
 * beginning, then drag, solved for at the step's end. A spring that the step does not resolve is
 * solved for at its end too, with all that it connects (stepped/nets): it stays stable, and loses
 * its oscillation. An element of any other kind acts as it is when the step begins.
 */
#ifndef RB_STEPPED_FORCE_H
#define RB_STEPPED_FORCE_H

#include "stepped/stepped_state.h"

RB_CHECKED enum rb_status rb_force_add(struct rb_world *world, const struct rb_cohort *cohort,
                                       double start_s, double h_s, struct rb_error *err);

#endif
