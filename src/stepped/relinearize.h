/* SPDX-License-Identifier: MIT */
/*
 * A step looked at again from where a try of it ends: what turning has made of gaps there that
 * straight ways did not tell.
 *
 * Groups with a joint that has drifted are solved once more with rows that know by how much
 * (stepped/joint_steps). Groups with an overlap get the points of their poses at the end instead,
 * their gaps taken as linear from there, and are solved once more, from the impulses that they
 * have: a Newton step on where bodies are at the end.
 */
#ifndef RB_STEPPED_RELINEARIZE_H
#define RB_STEPPED_RELINEARIZE_H

#include "stepped/stepped_state.h"

/*
 * After bodies have moved by what was solved for, before they rebound. `*again`: points, bends of
 * joints and velocities are new, positions those of the beginning again, with their velocities
 * solved; else nothing has changed. `inspections`: how often it has been done in this try.
 */
RB_CHECKED enum rb_status rb_relinearize(struct rb_world *world, struct rb_cohort *cohort,
                                         int inspections, bool *again, struct rb_error *err);

#endif
