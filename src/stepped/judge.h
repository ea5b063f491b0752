/* SPDX-License-Identifier: MIT */
/* Verdict on an attempt: for which bodies it is accepted, and what is said if for none. */
#ifndef RB_STEPPED_JUDGE_H
#define RB_STEPPED_JUDGE_H

#include "stepped/stepped_state.h"

/*
 * Marks `bad` those bodies of the cohort that are not finite, belong to an island whose residual is
 * too large, moved too far, or keep an overlap that position projection cannot close. In a cohort
 * that divides, rows of bad bodies may have been restored.
 */
RB_CHECKED enum rb_status rb_judge(struct rb_world *world, struct rb_cohort *cohort, double h_s,
                                   struct rb_attempt_outcome *outcome, struct rb_error *err);

/* Fails with the reason why no step was short enough. */
enum rb_status rb_judge_give_up(const struct rb_world *world, double start_s,
                                const struct rb_attempt_outcome *outcome, struct rb_error *err);

#endif
