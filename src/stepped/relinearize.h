/* SPDX-License-Identifier: MIT */
/*
 * Relinearization of a step at the end of an attempt: changes of gaps by rotation that the linear
 * model of the step lacks.
 *
 * Groups with a joint that has drifted are solved again with rows that contain the drift
 * (stepped/joint_steps). Groups with an overlap get contact points from their poses at the end,
 * with gaps linear about these, and are solved again from the present impulses: a Newton step on
 * the gaps at the end.
 */
#ifndef RB_STEPPED_RELINEARIZE_H
#define RB_STEPPED_RELINEARIZE_H

#include "stepped/stepped_state.h"

/*
 * Called after bodies have moved by the solution, before the rebound. `*again`: points, nonlinear
 * parts of joints and velocities are new and solved; positions are those of the beginning. Else
 * nothing has changed. `inspections`: earlier relinearizations of this attempt.
 */
RB_CHECKED enum rb_status rb_relinearize(struct rb_world *world, struct rb_cohort *cohort,
                                         int inspections, bool *again, struct rb_error *err);

#endif
