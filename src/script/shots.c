/* SPDX-License-Identifier: MIT */
#include "script/shots.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/vec3.h"
#include "script/call.h"
#include "script/functions.h"
#include "script/vector.h"

/*
 * What a call from outside hands to the protected function that serves it. The value is copied out
 * only when all went well.
 */
struct request {
	const char *key;
	int function;
	bool direction; /* a vector without length is none */
	double time_s;
	rb_vec3 value;
	char *text;     /* [RB_CAMERA_TEXT_SIZE]: where a text goes; NULL: a vector is wanted */
	double *number; /* where a positive number goes, the same */
};

/* Copies the text that the function has returned; a number is one, too. Cut between characters. */
static int take_text(lua_State *L, const struct request *request)
{
	size_t size;

	if (lua_type(L, -1) != LUA_TSTRING && lua_type(L, -1) != LUA_TNUMBER)
		return rb_function_refuse(L, request->function, request->key, "a text", -1);
	const char *const text = lua_tolstring(L, -1, &size);
	if (size > RB_CAMERA_TEXT_SIZE - 1)
		for (size = RB_CAMERA_TEXT_SIZE - 1;
		     size > 0 && ((unsigned char)text[size] & 0xc0) == 0x80;)
			size--;
	memcpy(request->text, text, size);
	request->text[size] = '\0';
	return 0;
}

/* Calls the function with the time and takes what it returns; in protected mode. */
static int serve(lua_State *L)
{
	struct request *request = lua_touserdata(L, 1);
	double numbers[3];

	rb_script_push_function(L, request->function);
	lua_pushnumber(L, request->time_s);
	lua_call(L, 1, 1);
	if (request->text)
		return take_text(L, request);
	if (request->number) {
		*request->number = lua_type(L, -1) == LUA_TNUMBER ? lua_tonumber(L, -1) : 0;
		if (!(*request->number > 0 && isfinite(*request->number)))
			return rb_function_refuse(L, request->function, request->key,
			                          "a positive number", -1);
		return 0;
	}
	const bool vector = rb_vector_numbers(L, -1, 3, numbers, NULL);
	if (vector)
		request->value = rb_vec3_from(numbers);
	if (!vector || !rb_vec3_finite(request->value))
		return rb_function_refuse(L, request->function, request->key,
		                          "a finite vector {x, y, z}", -1);
	if (request->direction && !(rb_vec3_max_abs(request->value) > 0))
		return rb_function_refuse(L, request->function, request->key,
		                          "a vector with a length", -1);
	return 0;
}

/*
 * One protected call. Random numbers follow from the time alone: those of the run are not touched,
 * so that it is the same with pictures and without.
 */
static enum rb_status ask(struct rb_script *script, struct request *request, struct rb_error *err)
{
	struct rb_sandbox *const sandbox = &script->sandbox;
	const uint64_t stream = sandbox->stream, index = sandbox->index;
	uint64_t bits;

	memcpy(&bits, &request->time_s, sizeof bits);
	sandbox->stream = bits;
	sandbox->index = 0;
	lua_pushcfunction(sandbox->L, serve);
	lua_pushlightuserdata(sandbox->L, request);
	const enum rb_status status = rb_sandbox_call(sandbox, 1, 0, script->callback_instructions,
	                                              err);
	sandbox->stream = stream;
	sandbox->index = index;
	return status;
}

/*
 * The error, with the camera, the key and the time behind it. A camera without a name is named by
 * its line.
 */
static enum rb_status tell(const struct rb_camera_def *camera, const struct request *request,
                           enum rb_status status, const struct rb_error *own, struct rb_error *err)
{
	if (camera->name)
		return RB_FAIL(err, status, "%s (camera '%s', %s at t = %.9g s)", own->text,
		               camera->name, request->key, request->time_s);
	return RB_FAIL(err, status, "%s (camera of line %d, %s at t = %.9g s)", own->text,
	               camera->line, request->key, request->time_s);
}

enum rb_status rb_script_shot(struct rb_script *script, const struct rb_model *model,
                              const struct rb_camera_def *camera, const struct rb_frame *frame,
                              struct rb_frame_shot *shot, struct rb_error *err)
{
	const struct {
		const char *key;
		const struct rb_camera_vector *vector;
		rb_vec3 *value;
	} parts[] = {{"position", &camera->position, &shot->position},
	             {"look_at", &camera->look_at, &shot->look_at},
	             {"up", &camera->up, &shot->up}};
	const enum rb_script_phase phase = script->phase;
	enum rb_status status = RB_OK;

	RB_ASSERT(frame && model && shot);
	script->phase = RB_PHASE_LOOK;
	script->frame = frame;
	script->frame_model = model;
	for (int i = 0; i < 3 && status == RB_OK; i++) {
		struct request request = {.key = parts[i].key,
		                          .function = parts[i].vector->function,
		                          .direction = i == 2,
		                          .time_s = frame->time_s};
		struct rb_error own;
		if (parts[i].vector->source != RB_CAMERA_FUNCTION)
			continue;
		status = ask(script, &request, &own);
		if (status == RB_OK)
			*parts[i].value = request.value;
		else
			status = tell(camera, &request, status, &own, err);
	}
	for (int i = 0; i < camera->text_count && status == RB_OK; i++) {
		struct request request = {.key = "text",
		                          .function = camera->texts[i].function,
		                          .time_s = frame->time_s,
		                          .text = shot->text[i]};
		struct rb_error own;
		if (camera->texts[i].function < 0)
			continue;
		status = ask(script, &request, &own);
		if (status != RB_OK)
			status = tell(camera, &request, status, &own, err);
	}
	script->phase = phase;
	script->frame = NULL;
	script->frame_model = NULL;
	return status;
}

/* Asks for the speed at a moment. */
static enum rb_status ask_speed(struct rb_script *script, const struct rb_camera_def *camera,
                                double time_s, double *speed, struct rb_error *err)
{
	struct request request = {.key = "speed",
	                          .function = camera->speed_function,
	                          .time_s = time_s,
	                          .number = speed};
	struct rb_error own;
	const enum rb_status status = ask(script, &request, &own);

	return status ? tell(camera, &request, status, &own, err) : RB_OK;
}

/* The mean speed over one picture, by the method of Runge and Kutta. */
static enum rb_status mean_speed(struct rb_script *script, const struct rb_camera_def *camera,
                                 const double span[2], double fps, double *mean,
                                 struct rb_error *err)
{
	static const double ahead[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
	enum rb_status status = RB_OK;
	double speed = 0;

	*mean = 0;
	for (int k = 0; k < 4 && !status; k++) {
		/* there may be nothing that the function can say of what is behind the end */
		const double time_s = fmin(span[0] + ahead[k] * speed / fps, span[1]);

		status = ask_speed(script, camera, time_s, &speed, err);
		*mean += weight[k] * speed;
	}
	*mean /= 6;
	return status;
}

static enum rb_status refuse_speed(const struct rb_script *script,
                                   const struct rb_camera_def *camera, double time_s,
                                   const char *what, struct rb_error *err)
{
	const struct request request = {.key = "speed", .time_s = time_s};
	const char *const file = camera->file ? camera->file : script->scene->file;
	struct rb_error own;
	const enum rb_status status = RB_FAIL(&own, RB_ERR_SCENE, "%s:%d: the speed %s", file,
	                                      camera->line, what);

	return tell(camera, &request, status, &own, err);
}

/*
 * Speeds are summed, not times: where they are whole numbers or the like, pictures fall on frames
 * to the bit, as those of a constant speed do.
 */
static enum rb_status list_pictures(struct rb_script *script, const struct rb_camera_def *camera,
                                    struct rb_picture_times *times, struct rb_error *err)
{
	enum { PICTURES_MAX = 1000000 }; /* four hours of film, and a second to ask for them */
	const double from_s = camera->from_s, to_s = times->to_s, fps = times->fps;
	enum rb_status status = RB_OK;
	double sum = 0, time_s = from_s;
	size_t capacity = 0, made = 0;

	while (!status && time_s <= to_s) {
		/* what rounding of times and of as many sums can make of the end */
		const double noise = 8 * DBL_EPSILON *
		                     (fabs(to_s) + fabs(from_s) + sum / fps * (double)(made + 1));
		double mean = 0;

		if (made == PICTURES_MAX)
			return refuse_speed(script, camera, time_s,
			                    "makes more than a million pictures", err);
		if (!rb_memory_reserve(&times->picture_s, &capacity, made + 1,
		                       sizeof *times->picture_s))
			return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare a film: out of memory");
		times->picture_s[made++] = time_s;
		times->count = made;
		status = mean_speed(script, camera, (const double[]){time_s, to_s}, fps, &mean,
		                    err);
		sum += mean;
		const double next_s = from_s + sum / fps;
		time_s = next_s > to_s && next_s - to_s <= noise ? to_s : next_s;
		if (!status && !(time_s > times->picture_s[made - 1])) {
			if (time_s == to_s)
				break;
			return refuse_speed(script, camera, time_s,
			                    "is too small to come any further", err);
		}
	}
	return status;
}

enum rb_status rb_script_pictures(struct rb_script *script, const struct rb_camera_def *camera,
                                  struct rb_picture_times *times, struct rb_error *err)
{
	const enum rb_script_phase phase = script->phase;

	RB_ASSERT(camera->speed_varies && isfinite(times->to_s));
	times->picture_s = NULL;
	times->count = 0;
	script->phase = RB_PHASE_LOOK;
	const enum rb_status status = list_pictures(script, camera, times, err);
	script->phase = phase;
	if (status) {
		rb_memory_free(times->picture_s);
		times->picture_s = NULL;
		times->count = 0;
	}
	return status;
}
