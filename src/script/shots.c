/* SPDX-License-Identifier: MIT */
#include "script/shots.h"

#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
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
	char *text; /* [RB_CAMERA_TEXT_SIZE]: where a text goes; NULL: a vector is wanted */
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
