/* SPDX-License-Identifier: MIT */
/*
 * One attempt of a step for bodies that step together: forces, contact points, impacts, solution,
 * motion, rebound.
 */
#ifndef RB_STEPPED_ATTEMPT_H
#define RB_STEPPED_ATTEMPT_H

#include "stepped/stepped_state.h"

/*
 * The cohort's rows in world->mark are those of the beginning. Residuals are stored in the solver's
 * islands.
 */
RB_CHECKED enum rb_status rb_attempt(struct rb_world *world, struct rb_cohort *cohort,
                                     double start_s, double h_s, struct rb_error *err);

/* Its results are not needed any more: beyond so many bytes of a list its memory may be taken. */
void rb_attempt_discard(const struct rb_cohort *cohort, size_t bytes);

#endif
