/* SPDX-License-Identifier: MIT */
/*
 * Runs after every substep: NaN and infinity are caught by summing a row's magnitudes, one test for
 * each body instead of ten.
 */
#include "step/verdict.h"

#include "base/error.h"

bool rb_verdict_finite(const struct rb_state *state, int index)
{
	RB_ASSERT_COSTLY(index >= 0 && index < state->body_count);

	const rb_vec3 p = rb_world_row3(state->position, index),
		      v = rb_world_row3(state->velocity, index);
	/* a sum of finite numbers that overflows is as bad */
	double sum = fabs(p.x) + fabs(p.y) + fabs(p.z) + fabs(v.x) + fabs(v.y) + fabs(v.z);

	if (state->spin) {
		const rb_vec3 w = rb_world_row3(state->spin, index);

		sum += fabs(w.x) + fabs(w.y) + fabs(w.z) +
		       fabs(state->orientation[4 * (size_t)index]);
	}
	return isfinite(sum);
}

enum rb_verdict rb_verdict_of(const struct rb_pass *pass, int *body)
{
	for (int k = 0; k < pass->member_count; k++)
		if (!rb_verdict_finite(&pass->world->state, pass->member[k])) {
			*body = pass->member[k];
			return RB_VERDICT_NOT_FINITE;
		}
	return pass->touch_count > 0 && pass->worst >= 0 &&
	                       pass->world->model->rollback != RB_ROLLBACK_NONE
	               ? RB_VERDICT_OVERLAP
	               : RB_VERDICT_GOOD;
}
