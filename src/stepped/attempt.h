/* SPDX-License-Identifier: MIT */
/* One try of a step for bodies that step together: forces, points, solution, motion, rebound. */
#ifndef RB_STEPPED_ATTEMPT_H
#define RB_STEPPED_ATTEMPT_H

#include "stepped/stepped_state.h"

/*
 * The rows of its bodies in the mark are those of the beginning. Residuals stand with the solver's
 * groups.
 */
RB_CHECKED enum rb_status rb_attempt(struct rb_world *world, struct rb_cohort *cohort,
                                     double start_s, double h_s, struct rb_error *err);

#endif
