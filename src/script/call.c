/* SPDX-License-Identifier: MIT */
/*
 * Where a mistake is, is found on Lua's stack: the innermost line of the scene's own file, because
 * a helper's line is not what the user wrote; the helper is named beside it.
 *
 * Repetitions of the same text are dropped one after the other, so that a loop over a thousand
 * bodies does not fill the screen.
 */
#include "script/call.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "base/hash.h"

int rb_scene_line(lua_State *L, char *helper, size_t helper_size)
{
	const struct rb_script *script = rb_script_of(L);
	lua_Debug at;
	bool caller = true;

	if (helper)
		helper[0] = '\0';
	for (int level = 1; lua_getstack(L, level, &at); level++) {
		lua_getinfo(L, "Sl", &at);
		if (at.currentline <= 0)
			continue;
		if (at.source[0] == '@' && strcmp(at.source + 1, script->source) == 0)
			return at.currentline;
		if (caller && helper)
			snprintf(helper, helper_size, " (in %s:%d)",
			         at.source + (at.source[0] == '@' || at.source[0] == '='),
			         at.currentline);
		caller = false;
	}
	return 0;
}

/* Adds a mistake: made printable, with its place in front. */
static void note(struct rb_script *script, int line, const char *text)
{
	char whole[sizeof script->first_mistake], place[256];

	snprintf(whole, sizeof whole, "%s%s",
	         rb_error_place(script->source, line, place, sizeof place), text);
	/* a text from the scene may hold anything: one line stays one line */
	for (char *c = whole; *c; c++)
		if ((unsigned char)*c < ' ' || *c == 127)
			*c = '?';
	/* a loop makes the same mistake again and again: once is enough */
	const uint64_t hash = rb_hash_bytes(whole, strlen(whole), 0);
	if (script->mistake_count > 0 && hash == script->last_mistake)
		return;
	script->last_mistake = hash;
	if (script->mistake_count++ == 0)
		memcpy(script->first_mistake, whole, sizeof whole);
	if (script->mistakes)
		rb_mistakes_add(script->mistakes, "%s", whole);
}

void rb_script_mistake(struct rb_script *script, int line, const char *format, ...)
{
	char text[800];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	note(script, line, text);
}

void rb_call_mistake(const struct rb_call *call, const char *format, ...)
{
	char text[800];
	va_list arguments;
	int used = snprintf(text, sizeof text, "%s%s: ", call->label, call->helper);

	va_start(arguments, format);
	vsnprintf(text + used, sizeof text - (size_t)used, format, arguments);
	va_end(arguments);
	note(call->script, call->line, text);
}

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

/* Writes a list of one to four such as {1, 2}; false: it is none, or too long. */
static bool describe_list(lua_State *L, int index, char out[80])
{
	size_t used = 1;
	const lua_Unsigned count = lua_rawlen(L, index);

	if (count < 1 || count > 4)
		return false;
	lua_Unsigned keys = 0;
	for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1))
		keys++;
	if (keys != count)
		return false;
	snprintf(out, 80, "{");
	for (lua_Unsigned i = 1; i <= count; i++) {
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
		if (!describe_list(L, index, out))
			snprintf(out, 80, "a table");
		break;
	case LUA_TUSERDATA:
		snprintf(out, 80, "%s",
		         rb_handle_id(L, index) >= 0                  ? "a body"
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

int rb_handle_id(lua_State *L, int index)
{
	const int *handle = luaL_testudata(L, index, RB_HANDLE_TYPE);

	/* any userdata may be asked */
	return handle ? *handle : -1;
}

struct rb_call rb_call_begin(lua_State *L, const char *word, const struct rb_row_table *table,
                             int index)
{
	struct rb_call call = {.L = L, .script = rb_script_of(L), .table = table};

	rb_script_while_loading(L, word);
	luaL_checkstack(L, 20, NULL);
	call.line = rb_scene_line(L, call.helper, sizeof call.helper);
	snprintf(call.label, sizeof call.label, "%s", word);
	if (index == 0)
		return call;
	char found[80];
	const bool table_given = lua_type(L, index) == LUA_TTABLE;
	if (!table_given)
		rb_call_mistake(&call, "expected a table of keys, like %s { ... } (got %s)", word,
		                rb_describe(L, index, found));
	else if (luaL_getmetafield(L, index, "__index") !=
	         LUA_TNIL) /* what it inherits would be passed over */
		rb_call_mistake(&call, "expected a plain table of keys (got one with '__index')");
	else
		call.index = index;
	if (call.index == 0)
		return call;
	lua_pushliteral(L, "name");
	if (rb_row_find(table, "name", NULL) && lua_rawget(L, index) == LUA_TSTRING)
		snprintf(call.label, sizeof call.label, "%s '%.60s'", word, lua_tostring(L, -1));
	lua_pop(L, 1);
	return call;
}

struct rb_call rb_call_part(const struct rb_call *call, const struct rb_row_table *table, int index,
                            int number)
{
	struct rb_call part = *call;
	char found[80];

	RB_ASSERT(number >= 0);
	part.table = table;
	part.given = part.wrong = 0;
	part.unknown = 0;
	part.index = lua_absindex(call->L, index);
	const size_t used = strlen(part.label);
	if (number > 0)
		snprintf(part.label + used, sizeof part.label - used, ": %s[%d]", table->name,
		         number);
	else
		snprintf(part.label + used, sizeof part.label - used, ": %s", table->name);
	if (lua_type(call->L, part.index) != LUA_TTABLE) {
		rb_call_mistake(&part, "must be a table of keys (got %s)",
		                rb_describe(call->L, part.index, found));
		part.index = 0;
	}
	return part;
}
