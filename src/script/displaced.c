/* SPDX-License-Identifier: MIT */
/* The notes are a table in the registry, so that they need no memory but the sandbox's. */
#include "script/displaced.h"

#include <stdio.h>

#include <lauxlib.h>

#include "model/joints.h"

static const char notes[] = "rbsim.displaced";
enum { WHERE = 1, BEFORE, BODY, METHOD };

/* Of joint k: the call, and how open it was before the first one. Pops nothing. */
static void note_joint(lua_State *L, int k, int id, const char *method)
{
	double allowed;

	if (lua_rawgeti(L, -1, k + 1) == LUA_TNIL) {
		lua_pop(L, 1);
		lua_createtable(L, METHOD, 0);
		lua_pushvalue(L, -1);
		lua_rawseti(L, -3, k + 1);
		lua_pushnumber(L, rb_world_joint_gap(rb_script_of(L)->world, k, &allowed));
		lua_rawseti(L, -2, BEFORE);
	}
	luaL_where(L, 1);
	lua_rawseti(L, -2, WHERE);
	lua_pushinteger(L, id);
	lua_rawseti(L, -2, BODY);
	lua_pushstring(L, method);
	lua_rawseti(L, -2, METHOD);
	lua_pop(L, 1);
}

void rb_displaced_note(lua_State *L, int id, const char *method)
{
	struct rb_script *const script = rb_script_of(L);
	const struct rb_scene *const scene = script->scene;

	for (int k = 0; k < scene->joint_count; k++) {
		if (scene->joints[k].a != id && scene->joints[k].b != id)
			continue;
		if (!script->has_displaced) {
			lua_newtable(L);
			lua_setfield(L, LUA_REGISTRYINDEX, notes);
			script->has_displaced = true;
		}
		lua_getfield(L, LUA_REGISTRYINDEX, notes);
		note_joint(L, k, id, method);
		lua_pop(L, 1);
	}
}

/* Raises the error of joint k, whose note is on top. */
static void refuse(lua_State *L, int k, double gap)
{
	const struct rb_scene *const scene = rb_script_of(L)->scene;
	char joint[96], body[96], open[32];

	lua_rawgeti(L, -1, WHERE);
	lua_rawgeti(L, -2, BODY);
	lua_rawgeti(L, -3, METHOD);
	rb_joint_label(scene, k, joint);
	rb_scene_body_label(scene, (int)lua_tointeger(L, -2), body);
	snprintf(open, sizeof open, "%.6g", gap);
	lua_pushfstring(L,
	                "%s%s: body %s opens %s by %s m (move what it holds likewise, in the same "
	                "callback, or release it)",
	                lua_tostring(L, -3), lua_tostring(L, -1), body, joint, open);
	lua_error(L);
}

void rb_displaced_check(lua_State *L)
{
	struct rb_script *const script = rb_script_of(L);

	if (!script->has_displaced)
		return;
	script->has_displaced = false;
	lua_getfield(L, LUA_REGISTRYINDEX, notes);
	for (int k = 0; k < script->scene->joint_count; k++) {
		double allowed;

		if (lua_rawgeti(L, -1, k + 1) == LUA_TNIL) {
			lua_pop(L, 1);
			continue;
		}
		lua_rawgeti(L, -1, BEFORE);
		const double before = lua_tonumber(L, -1);
		const double gap = rb_world_joint_gap(script->world, k, &allowed);
		lua_pop(L, 1);
		/* both ends moved alike leave it as it was; NaN is refused */
		if (!(gap <= before + allowed))
			refuse(L, k, gap);
		lua_pop(L, 1);
	}
	lua_pop(L, 1);
}
