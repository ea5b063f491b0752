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

enum rb_status rb_verdict_fail_finite(const struct rb_model *model, int body, double start_s,
                                      struct rb_error *err)
{
	char label[64], source[96];

	RB_ASSERT(body >= 0 && body < model->body_count);
	return RB_FAIL(err, RB_ERR_PHYSICS, "%sthe state of '%s' is not finite after t = %.9g s",
	               rb_scene_body_source(model->scene, model->id_of[body], source),
	               rb_scene_body_label(model->scene, model->id_of[body], label), start_s);
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
