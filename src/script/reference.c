/* SPDX-License-Identifier: MIT */
/*
 * The function gives a table of bodies, by name or handle; each body is looked up in it, and only
 * if the counts differ the table is searched for what no body has. So the usual case costs one
 * look-up for each body.
 */
#include "script/reference.h"

#include <math.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "math/quat.h"
#include "script/call.h"
#include "script/handles.h"
#include "script/vector.h"

/* Where script/expects keeps the function. */
static const char reference_key[] = "rbsim.reference";

struct request {
	double time_s;
	struct rb_reference_pose *poses;
	char place[160]; /* "bounce.lua:12: reference", as mistakes begin */
};

bool rb_script_has_reference(const struct rb_script *script)
{
	lua_State *L = script->sandbox.L;
	const bool has = lua_getfield(L, LUA_REGISTRYINDEX, reference_key) == LUA_TFUNCTION;

	lua_pop(L, 1);
	return has;
}

/*
 * The quaternion on top of the stack, made unit; raises an error unless its length is 1 within
 * 1e-3, as for orientations of bodies.
 */
static rb_quat check_orientation(lua_State *L, const char *place, const char *body)
{
	double numbers[4];
	bool right = rb_vector_numbers(L, -1, 4, numbers, NULL);
	double length = 0;

	for (int i = 0; right && i < 4; i++)
		right = isfinite(numbers[i]);
	if (right)
		length = rb_quat_length(rb_quat_from(numbers));
	if (fabs(length - 1) > 1e-3)
		luaL_error(L,
		           "%s: '%s': 'orientation' must be a quaternion {w, x, y, z} of length 1",
		           place, body);
	return rb_quat_unit(rb_quat_from(numbers));
}

/* Reads the pose from the table on top of the stack; raises an error for what is none. */
static void take_pose(lua_State *L, const char *place, const char *body,
                      struct rb_reference_pose *pose)
{
	char found[80];

	if (lua_type(L, -1) != LUA_TTABLE)
		luaL_error(L, "%s: '%s' must be a table {position = ...} (got %s)", place, body,
		           rb_describe(L, -1, found));
	lua_pushnil(L);
	while (lua_next(L, -2)) {
		const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
		char what[256];
		snprintf(what, sizeof what, "%s: '%s': '%s'", place, body, key);
		if (strcmp(key, "position") == 0) {
			pose->position = rb_vector_check(L, -1, what);
			pose->known |= RB_FIELD_POSITION;
		} else if (strcmp(key, "velocity") == 0) {
			pose->velocity = rb_vector_check(L, -1, what);
			pose->known |= RB_FIELD_VELOCITY;
		} else if (strcmp(key, "angular_velocity") == 0) {
			pose->angular_velocity = rb_vector_check(L, -1, what);
			pose->known |= RB_FIELD_ANGULAR_VELOCITY;
		} else if (strcmp(key, "orientation") == 0) {
			pose->orientation = check_orientation(L, place, body);
			pose->known |= RB_FIELD_ORIENTATION;
		} else {
			luaL_error(L,
			           "%s: '%s': unknown key '%s' (position, orientation, velocity or "
			           "angular_velocity)",
			           place, body, key);
		}
		lua_pop(L, 1);
	}
}

/*
 * Pushes what the table at index 2 has for a body, by name or else by handle; false with nothing
 * pushed: nothing.
 */
static bool push_body(lua_State *L, int id, const char *name)
{
	if (name) {
		lua_pushstring(L, name);
		if (lua_rawget(L, 2) != LUA_TNIL)
			return true;
		lua_pop(L, 1);
	}
	rb_handle_push(L, id);
	if (lua_rawget(L, 2) != LUA_TNIL)
		return true;
	lua_pop(L, 1);
	return false;
}

/*
 * Raises an error for a key that is no body: it would otherwise be measured nowhere without a word.
 */
static void check_names(lua_State *L, const char *place, const struct rb_scene *scene)
{
	lua_pushnil(L);
	while (lua_next(L, 2)) {
		bool known = rb_handle_id(L, -2) >= 0;
		const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : NULL;
		for (int id = 0; key && !known && id < scene->body_count; id++)
			known = scene->bodies[id].name && strcmp(scene->bodies[id].name, key) == 0;
		if (!known)
			luaL_error(L, "%s: no body is called '%s'", place, key ? key : "?");
		lua_pop(L, 1);
	}
}

/* Calls the function and fills the poses; in protected mode. */
static int serve(lua_State *L)
{
	struct request *request = lua_touserdata(L, 1);
	const struct rb_scene *scene = rb_script_of(L)->scene;
	lua_Debug about;
	lua_Integer stated = 0, found = 0;

	if (lua_getfield(L, LUA_REGISTRYINDEX, reference_key) != LUA_TFUNCTION)
		return luaL_error(L, "the scene states no reference");
	lua_pushvalue(L, -1);
	lua_getinfo(L, ">S", &about);
	rb_error_place(scene->file, about.linedefined, request->place,
	               sizeof request->place - strlen("reference"));
	strcat(request->place, "reference");
	lua_pushnumber(L, request->time_s);
	lua_call(L, 1, 1);
	char got[80];
	if (lua_type(L, 2) != LUA_TTABLE)
		return luaL_error(L, "%s: must return a table of bodies { NAME = {...} } (got %s)",
		                  request->place, rb_describe(L, 2, got));
	luaL_checkstack(L, 8, NULL);
	for (int id = 0; id < scene->body_count; id++) {
		const char *name = scene->bodies[id].name;
		if (!push_body(L, id, name))
			continue;
		take_pose(L, request->place, name ? name : scene->bodies[id].call,
		          &request->poses[id]);
		lua_pop(L, 1);
		found++;
	}
	lua_pushnil(L);
	while (lua_next(L, 2)) {
		stated++;
		lua_pop(L, 1);
	}
	if (stated != found)
		check_names(L, request->place, scene);
	return 0;
}

enum rb_status rb_script_reference(struct rb_script *script, struct rb_world *world, double time_s,
                                   struct rb_reference_pose *poses, struct rb_error *err)
{
	lua_State *L = script->sandbox.L;
	struct request request = {.time_s = time_s, .poses = poses};

	RB_ASSERT(poses != NULL);
	memset(poses, 0, (size_t)script->scene->body_count * sizeof *poses);
	script->phase = RB_PHASE_LOOK;
	script->world = world;
	lua_pushcfunction(L, serve);
	lua_pushlightuserdata(L, &request);
	const enum rb_status status = rb_sandbox_call(&script->sandbox, 1, 0,
	                                              script->callback_instructions, err);
	script->phase = RB_PHASE_REST;
	script->world = NULL;
	return status;
}
