/* SPDX-License-Identifier: MIT */
/*
 * As in Lua's lstrlib.c, with two differences: every search counts its steps against the script's
 * budget, and its texts are never owned by C, because any call into Lua may jump. In gmatch and
 * gsub the steps are settled after each match, since a callback in between may use up the same
 * budget.
 */
#include "script/strings.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "script/pattern.h"
#include "script/sandbox.h"

/*
 * A 1-based start that may be negative, as a 0-based offset in [0, size + 1]; size + 1 is behind
 * the end.
 */
static size_t start_offset(lua_Integer start, size_t size)
{
	if (start > 0)
		return (lua_Unsigned)start - 1 <= size ? (size_t)start - 1 : size + 1;
	if (start == 0)
		return 0;
	return (lua_Unsigned)0 - (lua_Unsigned)start <= size ? size - ((size_t)0 - (size_t)start)
	                                                     : 0;
}

/*
 * Charges the steps taken since there were `before`, each as one instruction; raises the pattern's
 * mistake.
 */
static void settle(lua_State *L, const struct rb_match *match, uint64_t before)
{
	rb_sandbox_charge(L, before - match->steps + (match->steps == 0));
	if (match->mistake)
		luaL_error(L, "%s", match->mistake);
}

/* The end of the match at `at`, with its steps charged; NULL: none. */
static const char *charged_match(lua_State *L, struct rb_match *match, const char *at,
                                 const char *pattern)
{
	const uint64_t before = match->steps = rb_sandbox_left(L);
	const char *end = rb_match_at(match, at, pattern);

	settle(L, match, before);
	return end;
}

/* Pushes capture i, or the whole match where there are none and i is 0. */
static void push_capture(lua_State *L, const struct rb_match *match, int i, const char *start,
                         const char *end)
{
	RB_ASSERT(i >= 0);
	if (i >= match->capture_count) {
		if (i != 0)
			luaL_error(L, "invalid capture index %%%d", i + 1);
		lua_pushlstring(L, start, (size_t)(end - start));
	} else if (match->capture[i].size == RB_CAPTURE_POSITION) {
		lua_pushinteger(L, match->capture[i].start - match->subject + 1);
	} else {
		if (match->capture[i].size == RB_CAPTURE_OPEN)
			luaL_error(L, "unfinished capture");
		lua_pushlstring(L, match->capture[i].start, (size_t)match->capture[i].size);
	}
}

/* Pushes all captures, the whole match where there are none but one is wanted; how many. */
static int push_captures(lua_State *L, const struct rb_match *match, const char *start,
                         const char *end, int least)
{
	const int count = match->capture_count > least ? match->capture_count : least;

	luaL_checkstack(L, count, "too many captures");
	for (int i = 0; i < count; i++)
		push_capture(L, match, i, start, end);
	return count;
}

/*
 * string.find without a pattern. Charged by bytes, 16 to an instruction, about what memmem
 * compares.
 */
static int find_plain(lua_State *L, const char *text, size_t size, size_t offset, const char *what,
                      size_t what_size)
{
	const char *found = what_size ? memmem(text + offset, size - offset, what, what_size)
	                              : text + offset;

	RB_ASSERT(offset <= size);
	rb_sandbox_charge(L, (found ? (size_t)(found - text) - offset : size - offset) / 16);
	if (!found) {
		lua_pushnil(L);
		return 1;
	}
	lua_pushinteger(L, found - text + 1);
	lua_pushinteger(L, found - text + (lua_Integer)what_size);
	return 2;
}

/* string.find and string.match. */
static int find_or_match(lua_State *L, bool find)
{
	size_t size, pattern_size;
	const char *text = luaL_checklstring(L, 1, &size);
	const char *pattern = luaL_checklstring(L, 2, &pattern_size);
	const size_t offset = start_offset(luaL_optinteger(L, 3, 1), size);
	struct rb_match match;

	if (offset > size) {
		lua_pushnil(L);
		return 1;
	}
	if (find && (lua_toboolean(L, 4) ||
	             (!strpbrk(pattern, "^$*+?.([%-") && strlen(pattern) == pattern_size)))
		return find_plain(L, text, size, offset, pattern, pattern_size);

	const bool anchored = pattern_size > 0 && *pattern == '^';
	const char *first = anchored ? pattern + 1 : pattern;
	const char *at = text + offset;
	uint64_t before = rb_sandbox_left(L);
	rb_match_start(&match, text, size, pattern, pattern_size, before);
	match.overtime = &rb_sandbox_of(L)->overtime;
	do {
		const char *end = rb_match_at(&match, at, first);
		if (match.mistake)
			break;
		if (end) {
			settle(L, &match, before);
			if (!find)
				return push_captures(L, &match, at, end, 1);
			lua_pushinteger(L, at - text + 1);
			lua_pushinteger(L, end - text);
			return push_captures(L, &match, NULL, NULL, 0) + 2;
		}
	} while (!anchored && at++ < match.subject_end);
	settle(L, &match, before);
	lua_pushnil(L);
	return 1;
}

static int l_find(lua_State *L)
{
	return find_or_match(L, true);
}

static int l_match(lua_State *L)
{
	return find_or_match(L, false);
}

/*
 * Iterator of gmatch. Upvalues: text, pattern, where to go on, where the last match ended (-1:
 * none), so that an empty match is not found there again.
 */
static int gmatch_step(lua_State *L)
{
	size_t size, pattern_size;
	const char *text = lua_tolstring(L, lua_upvalueindex(1), &size);
	const char *pattern = lua_tolstring(L, lua_upvalueindex(2), &pattern_size);
	const lua_Integer last = lua_tointeger(L, lua_upvalueindex(4));
	struct rb_match match;

	rb_match_start(&match, text, size, pattern, pattern_size, 0);
	match.overtime = &rb_sandbox_of(L)->overtime;
	for (lua_Integer at = lua_tointeger(L, lua_upvalueindex(3)); at <= (lua_Integer)size;
	     at++) {
		const char *end = charged_match(L, &match, text + at, pattern);
		if (!end || end - text == last)
			continue;
		lua_pushinteger(L, end - text);
		lua_copy(L, -1, lua_upvalueindex(3));
		lua_replace(L, lua_upvalueindex(4));
		return push_captures(L, &match, text + at, end, 1);
	}
	return 0;
}

static int l_gmatch(lua_State *L)
{
	size_t size;

	luaL_checklstring(L, 1, &size);
	luaL_checkstring(L, 2);
	const size_t offset = start_offset(luaL_optinteger(L, 3, 1), size);
	lua_settop(L, 2);
	lua_pushinteger(L, (lua_Integer)offset);
	lua_pushinteger(L, -1);
	lua_pushcclosure(L, gmatch_step, 4);
	return 1;
}

/* Adds the replacement text of argument 3 with its %0 to %9 replaced. */
static void add_template(lua_State *L, luaL_Buffer *out, const struct rb_match *match,
                         const char *start, const char *end)
{
	size_t size;
	const char *text = lua_tolstring(L, 3, &size);

	for (size_t i = 0; i < size; i++) {
		if (text[i] != '%') {
			luaL_addchar(out, text[i]);
			continue;
		}
		const char c = ++i < size ? text[i] : '\0';
		if (c == '%') {
			luaL_addchar(out, '%');
		} else if (c == '0') {
			luaL_addlstring(out, start, (size_t)(end - start));
		} else if (c >= '1' && c <= '9') {
			push_capture(L, match, c - '1', start, end);
			luaL_tolstring(L, -1, NULL);
			lua_remove(L, -2);
			luaL_addvalue(out);
		} else {
			luaL_error(L, "invalid use of '%%' in replacement string");
		}
	}
}

/*
 * Adds what stands for a match: the text, or what the table or function of argument 3 gives; false
 * and nil keep the match.
 */
static void add_replacement(lua_State *L, luaL_Buffer *out, const struct rb_match *match,
                            const char *start, const char *end)
{
	const int type = lua_type(L, 3);

	if (type == LUA_TFUNCTION) {
		lua_pushvalue(L, 3);
		const int count = push_captures(L, match, start, end, 1);
		lua_call(L, count, 1);
	} else if (type == LUA_TTABLE) {
		push_capture(L, match, 0, start, end);
		lua_gettable(L, 3);
	} else {
		add_template(L, out, match, start, end);
		return;
	}
	if (!lua_toboolean(L, -1)) {
		lua_pop(L, 1);
		luaL_addlstring(out, start, (size_t)(end - start));
	} else if (!lua_isstring(L, -1)) {
		luaL_error(L, "invalid replacement value (a %s)", luaL_typename(L, -1));
	} else {
		luaL_addvalue(out);
	}
}

static int l_gsub(lua_State *L)
{
	size_t size, pattern_size;
	const char *text = luaL_checklstring(L, 1, &size);
	const char *pattern = luaL_checklstring(L, 2, &pattern_size);
	const int type = lua_type(L, 3);
	const lua_Integer most = luaL_optinteger(L, 4, (lua_Integer)size + 1);
	const bool anchored = pattern_size > 0 && *pattern == '^';
	const char *first = anchored ? pattern + 1 : pattern;
	const char *at = text, *last = NULL;
	lua_Integer count = 0;
	struct rb_match match;
	luaL_Buffer out;

	luaL_argexpected(L,
	                 type == LUA_TNUMBER || type == LUA_TSTRING || type == LUA_TFUNCTION ||
	                         type == LUA_TTABLE,
	                 3, "string/function/table");
	luaL_buffinit(L, &out);
	rb_match_start(&match, text, size, pattern, pattern_size, 0);
	match.overtime = &rb_sandbox_of(L)->overtime;
	while (count < most) {
		const char *end = charged_match(L, &match, at, first);
		if (end && end != last) {
			count++;
			add_replacement(L, &out, &match, at, end);
			at = last = end;
		} else if (at < match.subject_end) {
			luaL_addchar(&out, *at++);
		} else {
			break;
		}
		if (anchored)
			break;
	}
	luaL_addlstring(&out, at, (size_t)(match.subject_end - at));
	luaL_pushresult(&out);
	lua_pushinteger(L, count);
	return 2;
}

void rb_strings_open(lua_State *L)
{
	static const luaL_Reg functions[] = {{"find", l_find},
	                                     {"match", l_match},
	                                     {"gmatch", l_gmatch},
	                                     {"gsub", l_gsub},
	                                     {NULL, NULL}};

	luaL_setfuncs(L, functions, 0);
}
