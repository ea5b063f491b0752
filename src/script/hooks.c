/* SPDX-License-Identifier: MIT */
/*
 * Calls into Lua are all made the same way: a request on the C stack, handed as a light userdata to
 * a C function that runs in protected mode and calls the scene's function. What the function may do
 * is given by the phase, and the world is set only while the call lasts, so a handle kept by the
 * scene cannot reach a world that is gone.
 */
#include "script/hooks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "base/memory.h"
#include "model/validate.h"
#include "script/call.h"
#include "script/displaced.h"
#include "script/expects.h"
#include "script/functions.h"
#include "script/globals.h"
#include "script/handles.h"
#include "script/joint_handles.h"
#include "script/measures.h"
#include "script/vector.h"

/* ---- while loading ---- */

static const struct {
	const char *name;
	unsigned hook;
} callbacks[RB_CALLBACK_COUNT] = {
	[RB_ON_STEP] = {"on_step", RB_HOOK_STEP},
	[RB_ON_FRAME] = {"on_frame", RB_HOOK_FRAME},
	[RB_ON_COLLISION] = {"on_collision", RB_HOOK_COLLISION},
	[RB_ON_TRANSITION] = {"on_transition", RB_HOOK_TRANSITION},
};

/*
 * Serves on_step and its like; upvalue: which. Several functions of one kind are called in the
 * order of the scene.
 */
static int l_callback(lua_State *L)
{
	const enum rb_callback which = (enum rb_callback)lua_tointeger(L, lua_upvalueindex(1));
	const struct rb_call call = rb_call_begin(L, callbacks[which].name, NULL, 0);
	struct rb_script *script = call.script;
	char found[80];

	if (lua_type(L, 1) != LUA_TFUNCTION) {
		rb_call_mistake(&call, "expected a function (got %s)", rb_describe(L, 1, found));
		return 0;
	}
	luaL_getsubtable(L, LUA_REGISTRYINDEX, callbacks[which].name);
	lua_pushvalue(L, 1);
	lua_rawseti(L, -2, ++script->callback_count[which]);
	script->scene->hooks |= callbacks[which].hook;
	return 0;
}

void rb_hooks_open(lua_State *L)
{
	for (int i = 0; i < RB_CALLBACK_COUNT; i++) {
		lua_pushinteger(L, i);
		lua_pushcclosure(L, l_callback, 1);
		lua_setglobal(L, callbacks[i].name);
	}
}

/* ---- while running ---- */

/* What a call from outside hands to the protected function that serves it. */
struct request {
	enum rb_callback which;
	int number; /* of the function among those of its kind */
	double time_s, dt_s;
	uint64_t frame;
	const struct rb_event *event;
	struct rb_expect_result *result;
	int expect;
	const struct rb_measure_def *measures; /* `measure_count` of them are asked for */
	int measure_count;
	const char *kind; /* what they are: "result", "probe" */
	double *values;   /* [measure_count] */
};

/* One protected call: `serve` gets the request as a light userdata. */
static enum rb_status ask(struct rb_script *script, struct rb_world *world, lua_CFunction serve,
                          struct request *request, enum rb_script_phase phase, struct rb_error *err)
{
	lua_State *L = script->sandbox.L;

	RB_ASSERT(script->phase == RB_PHASE_REST);
	script->phase = phase;
	script->world = world;
	script->has_displaced = false;
	lua_pushcfunction(L, serve);
	lua_pushlightuserdata(L, request);
	const enum rb_status status = rb_sandbox_call(&script->sandbox, 1, 0,
	                                              script->callback_instructions, err);
	script->phase = RB_PHASE_REST;
	script->world = NULL;
	if (status != RB_OK)
		rb_globals_explain(script, err);
	return status;
}

/* Pushes the function of the request. */
static void push_callback(lua_State *L, const struct request *request)
{
	RB_ASSERT(request->which < RB_CALLBACK_COUNT && request->number >= 1);
	luaL_getsubtable(L, LUA_REGISTRYINDEX, callbacks[request->which].name);
	lua_rawgeti(L, -1, request->number);
	lua_remove(L, -2);
}

static int serve_step(lua_State *L)
{
	const struct request *request = lua_touserdata(L, 1);

	push_callback(L, request);
	lua_pushnumber(L, request->time_s);
	lua_pushnumber(L, request->dt_s);
	lua_call(L, 2, 0);
	rb_displaced_check(L);
	return 0;
}

static int serve_frame(lua_State *L)
{
	const struct request *request = lua_touserdata(L, 1);

	push_callback(L, request);
	lua_pushnumber(L, request->time_s);
	lua_pushinteger(L, (lua_Integer)request->frame);
	lua_call(L, 2, 0);
	rb_displaced_check(L);
	return 0;
}

/* Pushes a table with what all events have in common. */
static void push_event(lua_State *L, const struct rb_event *event)
{
	lua_createtable(L, 0, 9);
	lua_pushnumber(L, event->time_s);
	lua_setfield(L, -2, "time");
	lua_pushstring(L, rb_event_kind_name(event->kind));
	lua_setfield(L, -2, "kind");
	rb_handle_push(L, event->a);
	lua_setfield(L, -2, "a");
	rb_handle_push(L, event->b);
	lua_setfield(L, -2, "b");
	rb_vector_push(L, event->point);
	lua_setfield(L, -2, "point");
	rb_vector_push(L, event->normal);
	lua_setfield(L, -2, "normal");
	if (event->joint == 0)
		return;
	rb_joint_handle_push(L, event->joint - 1);
	lua_setfield(L, -2, "joint");
}

static int serve_transition(lua_State *L)
{
	const struct request *request = lua_touserdata(L, 1);

	push_callback(L, request);
	push_event(L, request->event);
	lua_call(L, 1, 0);
	rb_displaced_check(L);
	return 0;
}

static int serve_collision(lua_State *L)
{
	const struct request *request = lua_touserdata(L, 1);
	const struct rb_event *event = request->event;

	push_callback(L, request);
	push_event(L, event);
	rb_vector_push(L, event->impulse);
	lua_setfield(L, -2, "impulse");
	lua_pushnumber(L, event->approach_speed);
	lua_setfield(L, -2, "approach_speed");
	lua_call(L, 1, 0);
	rb_displaced_check(L);
	return 0;
}

/* Calls all functions of a kind, one after the other, until one fails. */
static enum rb_status call_all(struct rb_script *script, struct rb_world *world,
                               lua_CFunction serve, struct request *request, struct rb_error *err)
{
	for (int i = 1; i <= script->callback_count[request->which]; i++) {
		request->number = i;
		const enum rb_status status = ask(script, world, serve, request, RB_PHASE_CHANGE,
		                                  err);
		if (status != RB_OK)
			return status;
	}
	return RB_OK;
}

static enum rb_status on_step(void *user, struct rb_world *world, double time_s, double dt_s,
                              struct rb_error *err)
{
	struct request request = {.which = RB_ON_STEP, .time_s = time_s, .dt_s = dt_s};

	return call_all(user, world, serve_step, &request, err);
}

static enum rb_status on_collision(void *user, struct rb_world *world, const struct rb_event *event,
                                   struct rb_error *err)
{
	struct request request = {.which = RB_ON_COLLISION, .event = event};

	return call_all(user, world, serve_collision, &request, err);
}

static enum rb_status on_transition(void *user, struct rb_world *world,
                                    const struct rb_event *event, struct rb_error *err)
{
	struct request request = {.which = RB_ON_TRANSITION, .event = event};

	return call_all(user, world, serve_transition, &request, err);
}

static enum rb_status field(void *user, int id, double time_s, const rb_vec3 at[2],
                            rb_vec3 force[2], struct rb_error *err)
{
	return rb_functions_field(user, id, time_s, at, force, err);
}

static enum rb_status potential(void *user, int id, double time_s, rb_vec3 position, double *energy,
                                struct rb_error *err)
{
	return rb_functions_potential(user, id, time_s, position, energy, err);
}

/* Whether a field has one. */
static bool has_potential(const struct rb_scene *scene)
{
	for (int i = 0; i < scene->field_count; i++)
		if (scene->fields[i].has_potential)
			return true;
	return false;
}

static enum rb_status motion(void *user, int id, double time_s, struct rb_driven_pose *pose,
                             struct rb_error *err)
{
	return rb_functions_motion(user, id, time_s, pose, err);
}

static enum rb_status follow(void *user, int joint, double time_s, double value[2],
                             struct rb_error *err)
{
	return rb_functions_follow(user, joint, time_s, value, err);
}

/* Whether the motor of some joint follows a function. */
static bool has_follower(const struct rb_scene *scene)
{
	for (int k = 0; k < scene->joint_count; k++)
		if (scene->joints[k].motor_function >= 0)
			return true;
	return false;
}

/* Whether some body is driven by a function. */
static bool has_driven(const struct rb_scene *scene)
{
	for (int i = 0; i < scene->body_count; i++)
		if (rb_body_is_driven(&scene->bodies[i]))
			return true;
	return false;
}

struct rb_world_hooks rb_script_hooks(struct rb_script *script)
{
	return (struct rb_world_hooks){
		.user = script,
		.step = script->callback_count[RB_ON_STEP] ? on_step : NULL,
		.collision = script->callback_count[RB_ON_COLLISION] ? on_collision : NULL,
		.transition = script->callback_count[RB_ON_TRANSITION] ? on_transition : NULL,
		.field = script->scene->field_count > 0 ? field : NULL,
		.potential = has_potential(script->scene) ? potential : NULL,
		.motion = has_driven(script->scene) ? motion : NULL,
		.follow = has_follower(script->scene) ? follow : NULL,
	};
}

/* ---- expectations ---- */

/* Calls an expectation's function and judges what it returns; in protected mode. */
static int serve_expect(lua_State *L)
{
	const struct request *request = lua_touserdata(L, 1);
	const struct rb_expect_def *def = &rb_script_of(L)->scene->expects[request->expect];
	struct rb_expect_result *result = request->result;

	rb_script_push_function(L, def->function);
	lua_call(L, 0, 2);
	rb_expect_judge(L, def, result);
	return 0;
}

/* Calls expectation i; `result` is whole also where this fails. */
static enum rb_status call_expect(struct rb_script *script, struct rb_world *world, int i,
                                  struct rb_expect_result *result, struct rb_error *err)
{
	const struct rb_expect_def *def = &script->scene->expects[i];
	struct request request = {.expect = i, .result = result};

	RB_ASSERT(i >= 0 && i < script->scene->expect_count);
	*result = (struct rb_expect_result){.text = def->text,
	                                    .line = def->line,
	                                    .always = def->always,
	                                    .failed_s = (double)NAN};
	return ask(script, world, serve_expect, &request, RB_PHASE_LOOK, err);
}

enum rb_status rb_script_on_frame(struct rb_script *script, struct rb_world *world, double time_s,
                                  uint64_t frame, struct rb_error *err)
{
	struct request request = {.which = RB_ON_FRAME, .time_s = time_s, .frame = frame};
	enum rb_status status = call_all(script, world, serve_frame, &request, err);

	if (!(script->scene->hooks & RB_HOOK_EXPECT_ALWAYS))
		return status;
	for (int i = 0; i < script->scene->expect_count && status == RB_OK; i++) {
		struct rb_expect_result now;
		if (!script->scene->expects[i].always)
			continue;
		status = call_expect(script, world, i, &now, err);
		if (status == RB_OK)
			rb_expect_remember(&script->expects[i], &now, time_s);
	}
	return status;
}

enum rb_status rb_script_expects(struct rb_script *script, struct rb_world *world,
                                 struct rb_expect_result *results, struct rb_error *err)
{
	enum rb_status first = RB_OK;
	struct rb_error broken;
	char *traceback = NULL; /* of the first one that broke: a call takes away the one before */

	for (int i = 0; i < script->scene->expect_count; i++) {
		const struct rb_expect_def *def = &script->scene->expects[i];
		if (def->always) {
			results[i] = rb_expect_recall(&script->expects[i], def);
			continue;
		}
		const enum rb_status status = call_expect(script, world, i, &results[i], &broken);
		if (status == RB_OK)
			continue;
		results[i].ok = results[i].has_numbers = false;
		snprintf(results[i].message, sizeof results[i].message, "%.*s",
		         RB_EXPECT_MESSAGE_SIZE - 1, broken.text);
		if (first == RB_OK) {
			first = status;
			if (err)
				*err = broken;
			traceback = script->sandbox.traceback;
			script->sandbox.traceback = NULL;
		}
		if (status != RB_ERR_SCENE)
			break;
	}
	if (traceback) {
		rb_memory_free(script->sandbox.traceback);
		script->sandbox.traceback = traceback;
	}
	return first;
}

/* ---- results and probes ---- */

/* In protected mode: asks for all measures of the request. */
static int serve_measures(lua_State *L)
{
	const struct request *request = lua_touserdata(L, 1);

	for (int i = 0; i < request->measure_count; i++)
		request->values[i] = rb_measure_ask(L, &request->measures[i], request->kind);
	return 0;
}

enum rb_status rb_script_probes(struct rb_script *script, struct rb_world *world, double *values,
                                struct rb_error *err)
{
	struct request request = {.measures = script->scene->probes,
	                          .measure_count = script->scene->probe_count,
	                          .kind = "probe",
	                          .values = values};

	return request.measure_count > 0
	               ? ask(script, world, serve_measures, &request, RB_PHASE_LOOK, err)
	               : RB_OK;
}

enum rb_status rb_script_results(struct rb_script *script, struct rb_world *world, double *values,
                                 struct rb_error *err)
{
	struct request request = {.measures = script->scene->results,
	                          .measure_count = script->scene->result_count,
	                          .kind = "result",
	                          .values = values};

	for (int i = 0; i < request.measure_count; i++)
		values[i] = (double)NAN;
	return request.measure_count > 0
	               ? ask(script, world, serve_measures, &request, RB_PHASE_LOOK, err)
	               : RB_OK;
}
