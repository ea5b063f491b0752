/* SPDX-License-Identifier: MIT */
/*
 * Movements are rows in the order in which they were given; each is applied to what the one before
 * it left. A movement takes effect at the first frame after it was given, and is computed there,
 * once, from where the camera then stands. So a film is the same however often its pictures are
 * drawn, and after a restart from a checkpoint, which keeps the rows and computes the rest again.
 */
#include "app/steering.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/field_list.h"
#include "base/log.h"
#include "base/memory.h"
#include "control/steer.h"
#include "flow/schedule.h"
#include "math/vec3.h"
#include "script/shots.h"

enum { LIMIT_FILM = 1, LIMIT_CELL, LIMIT_COUNT };

#define STEERING_FIELDS(X)                                                     \
	X(double, time_s, , "s", "of the frame before it", RB_FINITE)          \
	X(int, film, , "", "whose camera", RB_UP_TO(LIMIT_FILM))               \
	X(int, cell, , "", "which of its cameras", RB_UP_TO(LIMIT_CELL))       \
	X(enum rb_camera_action, action, , "", "what it does",                 \
	  RB_WITHIN(RB_CAMERA_MOVE, RB_CAMERA_ZOOM))                           \
	X(double, vector, [3], "m, rad", "as of struct rb_command", RB_FINITE) \
	X(double, factor, , "1", "as of struct rb_command", RB_FINITE)         \
	X(bool, is_made, , "", "the next frame has come", RB_DERIVED)          \
	X(double, made_s, , "s", "its time", RB_DERIVED)                       \
	X(struct rb_camera_def, camera, , "", "the camera since then", RB_DERIVED)
struct rb_steering_row {
	STEERING_FIELDS(RB_FIELD_MEMBER)
};
static RB_FIELDS_DEFINE(steering_fields, struct rb_steering_row, STEERING_FIELDS);

void rb_steering_release(struct rb_steering *steering)
{
	rb_memory_free(steering->row);
	*steering = (struct rb_steering){0};
}

enum rb_status rb_steering_add(struct rb_steering *steering, const struct rb_steering_film *film,
                               double time_s, const struct rb_player_aim *aim, struct rb_error *err)
{
	RB_ASSERT(film->number >= 0);
	if (!rb_memory_reserve(&steering->row, &steering->capacity, steering->count + 1,
	                       sizeof *steering->row))
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot move a camera: out of memory");
	steering->row[steering->count++] = (struct rb_steering_row){
		.time_s = time_s,
		.film = film->number,
		.cell = film->cell,
		.action = aim->action,
		.vector = {aim->vector[0], aim->vector[1], aim->vector[2]},
		.factor = aim->factor,
	};
	return RB_OK;
}

static bool is_of(const struct rb_steering_row *row, const struct rb_steering_film *film)
{
	return row->film == film->number && row->cell == film->cell;
}

/* The camera as it stands at a moment, without what its functions say. */
static const struct rb_camera_def *camera_at(const struct rb_steering *steering,
                                             const struct rb_steering_film *film, double time_s)
{
	const struct rb_camera_def *camera = film->camera;

	for (size_t k = 0; k < steering->count; k++)
		if (is_of(&steering->row[k], film) && steering->row[k].is_made &&
		    steering->row[k].made_s <= time_s)
			camera = &steering->row[k].camera;
	return camera;
}

/* Fills the shot with what the camera's functions say of the moment. */
static enum rb_status ask_functions(const struct rb_steering_film *film,
                                    const struct rb_camera_def *camera,
                                    const struct rb_frame *moment, struct rb_frame_shot *shot,
                                    struct rb_error *err)
{
	return rb_camera_has_functions(camera)
	               ? rb_script_shot(film->loaded->script, film->loaded->model, camera, moment,
	                                shot, err)
	               : RB_OK;
}

/*
 * Whether what the camera looks at is away from it by more than rounding: 1e-9 of the coordinates
 * leaves half of the digits for the direction.
 */
static bool can_look(const struct rb_steering_film *film, const struct rb_camera_def *camera,
                     const struct rb_frame *frame, const struct rb_frame_shot *shot)
{
	const struct rb_stand stand = rb_steer_stand(film->loaded->model, camera, frame, shot);
	const double size = rb_vec3_length(stand.eye) + rb_vec3_length(stand.target);
	const double away = rb_vec3_length(rb_vec3_sub(stand.eye, stand.target));

	return isfinite(size) && away > 1e-9 * size &&
	       (!camera->orthographic || camera->has_frustum ||
	        (camera->height > 0 && isfinite(camera->height)));
}

enum rb_status rb_steering_advance(struct rb_steering *steering,
                                   const struct rb_steering_film *film,
                                   const struct rb_frame *frame, struct rb_error *err)
{
	for (size_t k = 0; k < steering->count; k++) {
		struct rb_steering_row *const row = &steering->row[k];
		struct rb_frame_shot shot = {.camera = film->number};

		if (!is_of(row, film) || row->is_made || !(row->time_s < frame->time_s))
			continue;
		const struct rb_camera_def *const before = camera_at(steering, film, frame->time_s);
		row->camera = *before;
		const enum rb_status status = ask_functions(film, &row->camera, frame, &shot, err);
		if (status)
			return status;
		const struct rb_stand stand = rb_steer_stand(film->loaded->model, &row->camera,
		                                             frame, &shot);
		if (row->action == RB_CAMERA_MOVE)
			rb_steer_move(&row->camera, &stand, rb_vec3_from(row->vector));
		else if (row->action == RB_CAMERA_ORBIT)
			rb_steer_orbit(&row->camera, &stand, row->vector[0], row->vector[1]);
		else
			rb_steer_zoom(&row->camera, &stand, row->factor);
		if (!can_look(film, &row->camera, frame, &shot)) {
			rb_log(RB_LOG_WARNING,
			       "a camera does not move: it would reach the point that it looks at");
			row->camera = *before;
		}
		row->is_made = true;
		row->made_s = frame->time_s;
	}
	return RB_OK;
}

bool rb_steering_is_wanted(const struct rb_steering *steering, const struct rb_steering_film *film)
{
	return rb_camera_has_functions(film->camera) ||
	       camera_at(steering, film, (double)INFINITY) != film->camera;
}

enum rb_status rb_steering_shot(const struct rb_steering *steering,
                                const struct rb_steering_film *film, const struct rb_frame *moment,
                                struct rb_frame_shot *shot, struct rb_error *err)
{
	const struct rb_camera_def *const camera = camera_at(steering, film, moment->time_s);
	const enum rb_status status = ask_functions(film, camera, moment, shot, err);

	shot->enlarged = 1;
	if (status || camera == film->camera)
		return status;
	const struct rb_stand stand = rb_steer_stand(film->loaded->model, camera, moment, shot);
	shot->steered = true;
	shot->position = stand.eye;
	shot->look_at = stand.target;
	shot->up = stand.up;
	if (camera->orthographic)
		shot->enlarged = camera->has_frustum ? film->camera->frustum[3] / camera->frustum[3]
		                                     : film->camera->height / camera->height;
	return RB_OK;
}

void rb_steering_pack(struct rb_steering *steering, int film_count, struct rb_pack *pack)
{
	const int limit[LIMIT_COUNT] = {
		[LIMIT_FILM] = film_count - 1, [LIMIT_CELL] = RB_FILM_CELLS_MAX - 1};
	size_t count = steering ? steering->count : 0;

	rb_pack_count(pack, &count, INT32_MAX, rb_fields_bytes(steering_fields()));
	if (count == 0 || pack->failed)
		return;
	if (!steering) {
		rb_pack_fail(pack, "movements of cameras that make no film");
		return;
	}
	if (pack->loading) {
		if (!rb_memory_reserve(&steering->row, &steering->capacity, count,
		                       sizeof *steering->row)) {
			rb_pack_fail_memory(pack);
			return;
		}
		memset(steering->row, 0, count * sizeof *steering->row);
	}
	rb_fields_pack(steering_fields(), steering->row, count, limit, pack);
	steering->count = pack->failed ? 0 : count;
}
