/* SPDX-License-Identifier: MIT */
/* What has become of a try: for whom it is good, for whom not. */
#ifndef RB_STEPPED_JUDGE_H
#define RB_STEPPED_JUDGE_H

#include "stepped/stepped_state.h"

/*
 * Marks `bad` bodies of the cohort: not finite, of a group whose residual is too large, thrown too
 * far, or in an overlap that moving positions does not close. In a cohort that divides, rows of bad
 * bodies may have been restored.
 */
RB_CHECKED enum rb_status rb_judge(struct rb_world *world, struct rb_cohort *cohort, double h_s,
                                   struct rb_attempt_outcome *outcome, struct rb_error *err);

#endif
