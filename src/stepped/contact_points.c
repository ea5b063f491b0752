/* SPDX-License-Identifier: MIT */
#include "stepped/contact_points.h"

#include "base/memory.h"

RB_FIELDS_DEFINE(rb_named_impulse_fields, struct rb_named_impulse, RB_NAMED_IMPULSE_FIELDS);

enum rb_status rb_step_points_create(struct rb_step_points *points, const struct rb_model *model,
                                     struct rb_error *err)
{
	*points = (struct rb_step_points){.joins_arms = rb_levers_matter(model),
	                                  .body_count = model->body_count};
	points->first_last = rb_memory_take((size_t)model->body_count + 1,
	                                    sizeof *points->first_last);
	points->held = rb_memory_take((size_t)model->body_count + 1, 1);
	if (!points->first_last || !points->held)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for the contacts of %d bodies",
		               model->body_count);
	return RB_OK;
}

void rb_step_points_release(struct rb_step_points *points)
{
	rb_memory_free(points->row);
	rb_memory_free(points->chosen);
	rb_memory_free(points->last);
	rb_memory_free(points->first_last);
	rb_memory_free(points->held);
	*points = (struct rb_step_points){0};
}
