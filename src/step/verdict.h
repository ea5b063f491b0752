/* SPDX-License-Identifier: MIT */
/* Verdict on a substep: every number finite, no overlap beyond what step/gap allows. */
#ifndef RB_STEP_VERDICT_H
#define RB_STEP_VERDICT_H

#include "step/stage.h"

enum rb_verdict { RB_VERDICT_GOOD, RB_VERDICT_OVERLAP, RB_VERDICT_NOT_FINITE };

/* Whether all numbers of a body's motion are finite. */
bool rb_verdict_finite(const struct rb_state *state, int index);

/* RB_ERR_PHYSICS, and a message that names the body, whose state was finite at `start_s`. */
RB_CHECKED enum rb_status rb_verdict_fail_finite(const struct rb_model *model, int body,
                                                 double start_s, struct rb_error *err);

/* `*body` receives a body index when a state is not finite. */
enum rb_verdict rb_verdict_of(const struct rb_pass *pass, int *body);

#endif
