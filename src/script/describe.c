/* SPDX-License-Identifier: MIT */
#include "script/describe.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

/* 0/0 has a sign on some processors, which would be printed. */
static double unsigned_nan(double x)
{
	return isnan(x) ? (double)NAN : x;
}

/* Writes a number, a text or a boolean of a list; false: it is none of these. */
static bool describe_entry(lua_State *L, int index, char out[24])
{
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		snprintf(out, 24, "%.12g", unsigned_nan(lua_tonumber(L, index)));
		return true;
	case LUA_TSTRING:
		snprintf(out, 24, "'%.20s'", lua_tostring(L, index));
		return true;
	case LUA_TBOOLEAN:
		snprintf(out, 24, "%s", lua_toboolean(L, index) ? "true" : "false");
		return true;
	default:
		return false;
	}
}

long long rb_list_length(lua_State *L, int index)
{
	long long keys = 0;

	if (lua_type(L, index) != LUA_TTABLE)
		return -1;
	index = lua_absindex(L, index);
	for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1))
		keys++;
	return keys == (long long)lua_rawlen(L, index) ? keys : -1;
}

/* Writes a list of up to four such as {1, 2}; false: it is none, or too long. */
static bool describe_list(lua_State *L, int index, char out[80])
{
	size_t used = 1;
	const long long count = rb_list_length(L, index);

	if (count < 0 || count > 4)
		return false;
	snprintf(out, 80, "{");
	for (long long i = 1; i <= count; i++) {
		char entry[24];

		lua_rawgeti(L, index, (lua_Integer)i);
		const bool is = describe_entry(L, -1, entry);
		lua_pop(L, 1);
		if (!is || used + strlen(entry) > 72)
			return false;
		used += (size_t)snprintf(out + used, 80 - used, "%s%s", i > 1 ? ", " : "", entry);
	}
	snprintf(out + used, 80 - used, "}");
	return true;
}

/*
 * Writes "a list with the key 'x'" for a list that has such a key too (the first in order of the
 * alphabet); false: it has none, or no entries of a list.
 */
static bool describe_mixed(lua_State *L, int index, char out[80])
{
	const char *first = NULL;

	if (lua_rawlen(L, index) == 0)
		return false;
	for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1))
		if (lua_type(L, -2) == LUA_TSTRING) {
			const char *key = lua_tostring(L, -2);

			if (!first || strcmp(key, first) < 0)
				first = key;
		}
	if (first)
		snprintf(out, 80, "a list with the key '%.40s'", first);
	return first != NULL;
}

const char *rb_describe(lua_State *L, int index, char out[80])
{
	index = lua_absindex(L, index);
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		snprintf(out, 80, "%.14g", unsigned_nan(lua_tonumber(L, index)));
		break;
	case LUA_TSTRING:
		snprintf(out, 80, "the text '%.40s'", lua_tostring(L, index));
		break;
	case LUA_TBOOLEAN:
		snprintf(out, 80, "%s", lua_toboolean(L, index) ? "true" : "false");
		break;
	case LUA_TTABLE:
		if (!describe_list(L, index, out) && !describe_mixed(L, index, out))
			snprintf(out, 80, "a table");
		break;
	case LUA_TUSERDATA:
		snprintf(out, 80, "%s",
		         luaL_testudata(L, index, RB_HANDLE_TYPE)     ? "a body"
		         : luaL_testudata(L, index, RB_MATERIAL_TYPE) ? "a material"
		         : luaL_testudata(L, index, RB_JOINT_TYPE)    ? "a joint"
		                                                      : "an object");
		break;
	case LUA_TNIL:
	case LUA_TNONE:
		snprintf(out, 80, "nothing");
		break;
	default:
		snprintf(out, 80, "a %s", luaL_typename(L, index));
		break;
	}
	return out;
}
