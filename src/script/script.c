/* SPDX-License-Identifier: MIT */
/*
 * Functions of the scene are kept in one table of the registry under consecutive numbers, so that
 * the scene's C structs can hold an int where a Lua reference would need the state.
 */
#include "script/script.h"

#include <string.h>

#include <lauxlib.h>

#include "base/error.h"

static const char functions_key[] = "rbsim.functions";

void rb_script_need(lua_State *L, enum rb_status status, const struct rb_error *err)
{
	RB_ASSERT(status == RB_OK || status == RB_ERR_MEMORY || err);
	if (status == RB_OK)
		return;
	if (status == RB_ERR_MEMORY) {
		rb_sandbox_of(L)->refused = true;
		/* Lua's own words, by which sandbox/explain knows it */
		luaL_error(L, "not enough memory");
	}
	luaL_error(L, "%s", err->text);
}

int rb_script_keep_function(lua_State *L, int index)
{
	struct rb_script *script = rb_script_of(L);

	index = lua_absindex(L, index);
	luaL_getsubtable(L, LUA_REGISTRYINDEX, functions_key);
	lua_pushvalue(L, index);
	lua_rawseti(L, -2, ++script->function_count);
	lua_pop(L, 1);
	return script->function_count;
}

void rb_script_push_functions(lua_State *L)
{
	luaL_getsubtable(L, LUA_REGISTRYINDEX, functions_key);
}

void rb_script_push_function(lua_State *L, int number)
{
	RB_ASSERT(number >= 1);
	rb_script_push_functions(L);
	lua_rawgeti(L, -1, number);
	lua_remove(L, -2);
}

void rb_script_while_loading(lua_State *L, const char *call)
{
	const enum rb_script_phase phase = rb_script_of(L)->phase;

	if (phase == RB_PHASE_LOAD)
		return;
	if (phase != RB_PHASE_ADD)
		luaL_error(L, "%s: only while the scene is loaded, not in a callback", call);
	if (strcmp(call, "camera") != 0 && strcmp(call, "film") != 0 &&
	    strcmp(call, "require") != 0)
		luaL_error(L, "%s: not here: this file can only add cameras", call);
}
