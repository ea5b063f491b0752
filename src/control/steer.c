/* SPDX-License-Identifier: MIT */
/*
 * Movements are relative to where the camera stands at this frame (struct rb_stand), which is
 * computed with its mount, functions and followed bodies; the result is written back into the
 * definition, so that it goes on from there. What depended on a function is then fixed, because a
 * function cannot be moved.
 */
#include "control/steer.h"

#include <math.h>

#include "base/error.h"
#include "math/quat.h"
#include "math/vec3.h"

/*
 * rad between the line of sight and the horizon, a little below pi/2: at the pole "right" is not
 * defined and the picture would flip.
 */
static const double steepest = 1.55; /* rad between the line of sight and the horizon */

rb_vec3 rb_steer_body(const struct rb_model *model, const struct rb_frame *frame, int id)
{
	const int index = model->index_of[id];

	RB_ASSERT(id >= 0 && id < model->body_count + model->static_count);
	if (index < model->body_count && frame && frame->position)
		return rb_vec3_from(frame->position + 3 * index);
	return model->position[index];
}

struct rb_camera_def rb_steer_default(const struct rb_model *model)
{
	struct rb_camera_def camera = rb_camera_def_default();
	const int first = model->body_count > 0 ? 0 : model->body_count;
	const int last = model->body_count > 0 ? model->body_count : model->static_count;
	rb_vec3 low = {(double)INFINITY, (double)INFINITY, (double)INFINITY},
		high = {-(double)INFINITY, -(double)INFINITY, -(double)INFINITY};

	for (int i = first; i < last; i++) {
		const double r = rb_model_reach(model, i);
		const rb_vec3 p = model->position[i];
		low = (rb_vec3){fmin(low.x, p.x - r), fmin(low.y, p.y - r), fmin(low.z, p.z - r)};
		high = (rb_vec3){fmax(high.x, p.x + r), fmax(high.y, p.y + r),
		                 fmax(high.z, p.z + r)};
	}
	double radius = last > first ? 0.5 * rb_vec3_length(rb_vec3_sub(high, low)) : 1;
	if (!(radius > 0))
		radius = 1;
	const rb_vec3 side = camera.position.value;
	/*
	 * the ball around all fits the field of view at radius / sin(fov / 2); 1.4 leaves a margin
	 */
	const double distance = 1.4 * radius / sin(camera.fov / 2) / rb_vec3_length(side);
	if (last > first)
		camera.look_at.value = rb_vec3_scale(0.5, rb_vec3_add(low, high));
	camera.position.value = rb_vec3_add_scaled(camera.look_at.value, distance, side);
	camera.framed = true;
	return camera;
}

/*
 * World vector of a camera's property at a frame, m. `shot`: the value of its function, NULL: there
 * is none.
 */
static rb_vec3 vector(const struct rb_camera_vector *from, const struct rb_model *model,
                      const struct rb_frame *frame, const rb_vec3 *shot)
{
	if (from->source == RB_CAMERA_BODY)
		return rb_steer_body(model, frame, from->body);
	if (from->source == RB_CAMERA_FUNCTION && shot)
		return *shot;
	return from->value;
}

struct rb_stand rb_steer_stand(const struct rb_model *model, const struct rb_camera_def *camera,
                               const struct rb_frame *frame, const struct rb_frame_shot *shot)
{
	struct rb_stand stand = {
		.eye = vector(&camera->position, model, frame, shot ? &shot->position : NULL),
		.target = vector(&camera->look_at, model, frame, shot ? &shot->look_at : NULL),
	};
	rb_vec3 up = vector(&camera->up, model, frame, shot ? &shot->up : NULL);

	if (camera->mount >= 0) {
		const int index = model->index_of[camera->mount];
		const bool turns = index < model->body_count && frame && frame->orientation;
		const rb_quat q = turns ? rb_quat_from(frame->orientation + 4 * index)
		                        : model->orientation[index];
		const rb_vec3 offset = camera->level ? camera->offset
		                                     : rb_quat_rotate(q, camera->offset);
		stand.eye = rb_vec3_add(rb_steer_body(model, frame, camera->mount), offset);
		if (!camera->level && camera->up.source == RB_CAMERA_FIXED)
			up = rb_quat_rotate(q, up);
	}
	/* a body as "up" is a place: the direction to it is meant */
	if (camera->up.source == RB_CAMERA_BODY)
		up = rb_vec3_sub(up, stand.eye);
	stand.back = rb_vec3_unit(rb_vec3_sub(stand.eye, stand.target), (rb_vec3){0, -1, 0});
	stand.right = rb_vec3_unit(rb_vec3_cross(up, stand.back), rb_vec3_across(stand.back));
	stand.up = rb_vec3_cross(stand.back, stand.right);
	return stand;
}

/* From here on constant. */
static void fix(struct rb_camera_vector *vector, rb_vec3 value)
{
	vector->source = RB_CAMERA_FIXED;
	vector->value = value;
}

/* Moves the eye to `eye`, m, world; of a mounted camera, its offset from the body. */
static void put_eye(struct rb_camera_def *camera, const struct rb_stand *stand, rb_vec3 eye)
{
	if (camera->mount < 0) {
		fix(&camera->position, eye);
		return;
	}
	/* along the world's axes from here on: the offset is one in the world */
	const rb_vec3 change = rb_vec3_sub(eye, stand->eye);
	if (!camera->level) {
		camera->level = true;
		fix(&camera->up, stand->up);
	}
	camera->offset = rb_vec3_add(camera->offset, change);
}

void rb_steer_move(struct rb_camera_def *camera, const struct rb_stand *stand, rb_vec3 by)
{
	rb_vec3 change = rb_vec3_scale(by.x, stand->right);

	change = rb_vec3_add_scaled(change, by.y, stand->up);
	change = rb_vec3_add_scaled(change, -by.z, stand->back);
	put_eye(camera, stand, rb_vec3_add(stand->eye, change));
	if (camera->look_at.source != RB_CAMERA_BODY)
		fix(&camera->look_at, rb_vec3_add(stand->target, change));
}

void rb_steer_orbit(struct rb_camera_def *camera, const struct rb_stand *stand, double around,
                    double over)
{
	const rb_vec3 vertical = camera->up.source == RB_CAMERA_FIXED
	                                 ? rb_vec3_unit(camera->up.value, stand->up)
	                                 : stand->up;
	/* rad over the horizon; the clamp keeps rounding out of asin */
	const double height = asin(fmin(fmax(rb_vec3_dot(stand->back, vertical), -1), 1));
	const double wanted = fmin(fmax(height + over, -steepest), steepest);
	const rb_vec3 tilt = rb_vec3_scale(height - wanted, stand->right);
	rb_vec3 arm = rb_vec3_sub(stand->eye, stand->target);

	arm = rb_quat_rotate(rb_quat_from_turn(tilt), arm);
	arm = rb_quat_rotate(rb_quat_from_turn(rb_vec3_scale(around, vertical)), arm);
	if (camera->look_at.source == RB_CAMERA_FUNCTION)
		fix(&camera->look_at, stand->target);
	put_eye(camera, stand, rb_vec3_add(stand->target, arm));
}

void rb_steer_zoom(struct rb_camera_def *camera, const struct rb_stand *stand, double factor)
{
	const rb_vec3 arm = rb_vec3_sub(stand->eye, stand->target);

	RB_ASSERT(factor > 0);
	/* Going nearer would not make anything larger. */
	if (camera->orthographic) {
		camera->height /= factor;
		for (int k = 0; k < 4; k++)
			camera->frustum[k] /= factor;
		return;
	}
	put_eye(camera, stand, rb_vec3_add_scaled(stand->target, 1 / factor, arm));
}

void rb_steer_mount(struct rb_camera_def *camera, const struct rb_stand *stand, int id, rb_vec3 at)
{
	camera->mount = id;
	camera->level = true;
	if (id >= 0)
		camera->offset = rb_vec3_sub(stand->eye, at);
	else
		fix(&camera->position, stand->eye);
}

void rb_steer_follow(struct rb_camera_def *camera, const struct rb_stand *stand, int id)
{
	if (id < 0) {
		fix(&camera->look_at, stand->target);
		return;
	}
	if (camera->position.source == RB_CAMERA_FUNCTION)
		fix(&camera->position, stand->eye);
	camera->look_at.source = RB_CAMERA_BODY;
	camera->look_at.body = id;
}
