/* SPDX-License-Identifier: MIT */
#include "script/handle_kind.h"

#include <string.h>

#include "base/error.h"
#include "script/advice.h"
#include "script/describe.h"
#include "script/nearest.h"

void rb_handle_kind_push(lua_State *L, const struct rb_handle_kind *kind, int id)
{
	RB_ASSERT(id >= 0);
	luaL_getsubtable(L, LUA_REGISTRYINDEX, kind->key);
	if (lua_rawgeti(L, -1, id + 1) == LUA_TNIL) {
		lua_pop(L, 1);
		int *handle = lua_newuserdatauv(L, sizeof *handle, 0);
		*handle = id;
		luaL_setmetatable(L, kind->type);
		lua_pushvalue(L, -1);
		lua_rawseti(L, -3, id + 1);
	}
	lua_remove(L, -2);
}

int rb_handle_kind_self(lua_State *L, const struct rb_handle_kind *kind, const char *method)
{
	const int *handle = luaL_testudata(L, 1, kind->type);

	if (!handle)
		luaL_error(L, "%s: called without its %s (write %s:%s(...))", method, kind->word,
		           kind->word, method);
	return *handle;
}

int rb_handle_kind_change(lua_State *L, const struct rb_handle_kind *kind, const char *method)
{
	const struct rb_script *script = rb_script_of(L);
	const int id = rb_handle_kind_self(L, kind, method);

	if (script->phase != RB_PHASE_CHANGE || !script->world)
		luaL_error(L, "%s: only in on_step, on_frame, on_collision and on_transition",
		           method);
	return id;
}

static const struct rb_handle_kind *kind_of(lua_State *L)
{
	return lua_touserdata(L, lua_upvalueindex(1));
}

/* Upvalue 2: methods by name, and places of fields. */
static int l_index(lua_State *L)
{
	const struct rb_handle_kind *const kind = kind_of(L);
	const int id = rb_handle_kind_self(L, kind, "a field");
	char label[96], hint[96];

	if (lua_type(L, 2) != LUA_TSTRING)
		return luaL_error(L, "a %s has no field %s", kind->word, rb_describe(L, 2, label));
	const char *key = lua_tostring(L, 2);
	lua_pushvalue(L, 2);
	const int type = lua_rawget(L, lua_upvalueindex(2));
	if (type == LUA_TNUMBER)
		return kind->field[lua_tointeger(L, -1)].get(L, id);
	if (type != LUA_TNIL)
		return 1;
	const char *const advice = rb_advice_for_field(key);
	if (advice && strcmp(kind->word, "body") == 0)
		return luaL_error(L, "%s %s has no field '%s' (did you mean '%s'?)", kind->word,
		                  kind->label(rb_script_of(L)->scene, id, label), key, advice);
	struct rb_nearest nearest = rb_nearest_to(key);
	for (int i = 0; i < kind->field_count; i++)
		rb_nearest_offer(&nearest, kind->field[i].name, strlen(kind->field[i].name));
	for (const luaL_Reg *method = kind->method; method->name; method++)
		rb_nearest_offer(&nearest, method->name, strlen(method->name));
	return luaL_error(L, "%s %s has no field '%s'%s", kind->word,
	                  kind->label(rb_script_of(L)->scene, id, label), key,
	                  rb_nearest_hint(&nearest, hint));
}

static int l_newindex(lua_State *L)
{
	const struct rb_handle_kind *const kind = kind_of(L);
	const char *key = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";

	for (int i = 0; i < kind->field_count; i++) {
		if (strcmp(kind->field[i].name, key) != 0)
			continue;
		if (kind->field[i].instead)
			return luaL_error(L,
			                  "a %s's '%s' can't be assigned: call %s:%s in a callback",
			                  kind->word, key, kind->word, kind->field[i].instead);
		if (kind->changed_by)
			return luaL_error(L, "a %s's '%s' can't be assigned (%s)", kind->word, key,
			                  kind->changed_by);
		return luaL_error(L, "a %s's '%s' can't be changed", kind->word, key);
	}
	return luaL_error(L, "a %s has no field '%s' to assign (keep your own values in a table)",
	                  kind->word, key);
}

static int l_tostring(lua_State *L)
{
	const struct rb_handle_kind *const kind = kind_of(L);
	const int id = rb_handle_kind_self(L, kind, "tostring");
	char label[96];

	lua_pushfstring(L, "%s %s", kind->word, kind->label(rb_script_of(L)->scene, id, label));
	return 1;
}

/* Sets a function of the metatable on top of the stack, with the kind and `count` more upvalues. */
static void set(lua_State *L, const struct rb_handle_kind *kind, const char *name,
                lua_CFunction function, int count)
{
	lua_pushlightuserdata(L, (void *)(uintptr_t)kind);
	if (count > 0)
		lua_insert(L, -2);
	lua_pushcclosure(L, function, 1 + count);
	lua_setfield(L, -2, name);
}

void rb_handle_kind_open(lua_State *L, const struct rb_handle_kind *kind)
{
	luaL_newmetatable(L, kind->type);
	lua_createtable(L, 0, kind->field_count);
	luaL_setfuncs(L, kind->method, 0);
	for (int i = 0; i < kind->field_count; i++) {
		lua_pushinteger(L, i);
		lua_setfield(L, -2, kind->field[i].name);
	}
	set(L, kind, "__index", l_index, 1);
	set(L, kind, "__newindex", l_newindex, 0);
	set(L, kind, "__tostring", l_tostring, 0);
	lua_pushinteger(L, kind->order);
	lua_setfield(L, -2, "__order");
	lua_pushstring(L, kind->word);
	lua_setfield(L, -2, "__metatable");
	lua_pop(L, 1);
}
