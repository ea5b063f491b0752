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

struct rb_call rb_call_entry(const struct rb_call *call, const char *list, int number)
{
	struct rb_call entry = *call;

	RB_ASSERT(number >= 0);
	entry.given = entry.wrong = 0;
	entry.unknown = 0;
	entry.index = entry.values = 0;
	size_t used = strlen(entry.label);
	if (*list)
		snprintf(entry.label + used, sizeof entry.label - used, ": %s", list);
	used = strlen(entry.label);
	if (number > 0)
		snprintf(entry.label + used, sizeof entry.label - used, "[%d]", number);
	return entry;
}

struct rb_call rb_call_part(const struct rb_call *call, const struct rb_row_table *table, int index,
                            int number)
{
	struct rb_call part = rb_call_entry(call, table->name, number);
	char found[80];

	part.table = table;
	part.index = lua_absindex(call->L, index);
	if (lua_type(call->L, part.index) != LUA_TTABLE) {
		rb_call_mistake(&part, "must be a table of keys (got %s)",
		                rb_describe(call->L, part.index, found));
		part.index = 0;
	}
	return part;
}
