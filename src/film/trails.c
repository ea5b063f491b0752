/* SPDX-License-Identifier: MIT */
/*
 * Points of the bodies' centres of mass at frames, at most RB_TRAIL_POINTS_MAX: when full, every
 * second one is dropped and the stride doubles, so that a trail covers any length of run in bounded
 * memory.
 */
#include "film/trails.h"

#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/center.h"

enum rb_status rb_trails_init(struct rb_trails *trails, const struct rb_model *model,
                              const struct rb_camera_def *camera, struct rb_error *err)
{
	*trails = (struct rb_trails){.stride = 1, .model = model};
	for (int i = 0; i < camera->trail_count; i++) {
		const int index = model->index_of[camera->trails[i]];
		if (index < model->body_count)
			trails->index[trails->path_count++] = index;
	}
	if (trails->path_count == 0)
		return RB_OK;
	trails->points = rb_memory_take((size_t)trails->path_count, sizeof *trails->points);
	trails->time_s = rb_memory_take(RB_TRAIL_POINTS_MAX, sizeof *trails->time_s);
	if (trails->points && trails->time_s)
		return RB_OK;
	const int count = trails->path_count;
	rb_trails_release(trails);
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep the trails of %d bodies: out of memory",
	               count);
}

void rb_trails_release(struct rb_trails *trails)
{
	rb_memory_free(trails->points);
	rb_memory_free(trails->time_s);
	*trails = (struct rb_trails){0};
}

/* Drops every second point and doubles the stride; the first point stays. */
static void thin_out(struct rb_trails *trails)
{
	const int left = (trails->point_count + 1) / 2;

	for (int p = 0; p < trails->path_count; p++)
		for (int i = 1; i < left; i++)
			memcpy(trails->points[p][i], trails->points[p][2 * i],
			       sizeof trails->points[p][i]);
	for (int i = 1; i < left; i++)
		trails->time_s[i] = trails->time_s[2 * i];
	RB_ASSERT(left <= RB_TRAIL_POINTS_MAX);
	trails->point_count = left;
	trails->stride *= 2;
}

/* Centre of mass of a moving body, world axes. */
static rb_vec3 center_of(const struct rb_model *model, const struct rb_frame *frame, int index)
{
	const rb_vec3 origin = rb_vec3_from(frame->position + 3 * index);

	const rb_quat orientation = frame->orientation
	                                    ? rb_quat_from(frame->orientation + 4 * index)
	                                    : model->orientation[index];
	return rb_model_center(model, index, origin, orientation);
}

void rb_trails_add(struct rb_trails *trails, const struct rb_frame *frame)
{
	if (trails->path_count == 0 || !frame->position)
		return;
	if (trails->seen % trails->stride == 0 && trails->point_count == RB_TRAIL_POINTS_MAX)
		thin_out(trails);
	if (trails->seen++ % trails->stride != 0)
		return;
	for (int p = 0; p < trails->path_count; p++)
		rb_vec3_to(trails->points[p][trails->point_count],
		           center_of(trails->model, frame, trails->index[p]));
	trails->time_s[trails->point_count++] = frame->time_s;
}
