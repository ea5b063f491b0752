/* SPDX-License-Identifier: MIT */
/* Callbacks are not watched: their calls refuse nil. */
#include "script/globals.h"

#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "base/log.h"
#include "script/advice.h"
#include "script/call.h"
#include "script/nearest.h"

/* Offers the locals of all functions that are being run. */
static void offer_locals(lua_State *L, struct rb_nearest *nearest)
{
	const char *name;
	lua_Debug at;

	for (int level = 1; lua_getstack(L, level, &at); level++)
		for (int i = 1; (name = lua_getlocal(L, &at, i)) != NULL; i++) {
			if (name[0] != '(') /* "(temporary)" */
				rb_nearest_offer(nearest, name, strlen(name));
			lua_pop(L, 1);
		}
}

/* What could be meant by a name: the nearest of what is defined, or advice. */
static void find_hint(lua_State *L, const char *name, char *out, size_t size)
{
	const char *const advice = rb_advice_for_global(name);
	struct rb_nearest nearest = rb_nearest_to(name);
	char hint[96];

	offer_locals(L, &nearest);
	lua_pushglobaltable(L);
	for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1))
		if (lua_type(L, -2) == LUA_TSTRING) {
			size_t candidate_size;
			const char *const candidate = lua_tolstring(L, -2, &candidate_size);
			rb_nearest_offer(&nearest, candidate, candidate_size);
		}
	lua_pop(L, 1);
	if (advice && !nearest.best[0])
		snprintf(out, size, " (%s)", advice);
	else
		snprintf(out, size, "%s", rb_nearest_hint(&nearest, hint));
}

/* __index of the table of globals: (table, name). */
static int read_undefined(lua_State *L)
{
	struct rb_script *const script = rb_script_of(L);
	char helper[sizeof script->undefined->helper];
	lua_Debug at;

	lua_pushnil(L);
	if (script->phase != RB_PHASE_LOAD || lua_type(L, 2) != LUA_TSTRING ||
	    !lua_getstack(L, 1, &at))
		return 1;
	lua_getinfo(L, "l", &at);
	if (at.currentline <= 0) /* C has asked */
		return 1;
	luaL_checkstack(L, 20, NULL);
	const char *const name = lua_tostring(L, 2);
	const int line = rb_scene_line(L, helper, sizeof helper), count = script->undefined_count;
	for (int k = 0; k < count; k++)
		if (strcmp(script->undefined[k].name, name) == 0)
			return 1;
	if (count == RB_UNDEFINED_MAX || strlen(name) >= sizeof script->undefined->name)
		return 1;
	struct rb_undefined *const undefined = &script->undefined[script->undefined_count++];
	*undefined = (struct rb_undefined){.line = line};
	memcpy(undefined->name, name, strlen(name) + 1);
	memcpy(undefined->helper, helper, sizeof helper);
	find_hint(L, name, undefined->hint, sizeof undefined->hint);
	return 1;
}

void rb_globals_watch(lua_State *L)
{
	lua_pushglobaltable(L);
	lua_createtable(L, 0, 1);
	lua_pushcfunction(L, read_undefined);
	lua_setfield(L, -2, "__index");
	lua_setmetatable(L, -2);
	lua_pop(L, 1);
}

/* Whether the line reads the global as a field of _G, which is on purpose: _G.name, _G["name"]. */
static bool names_table(const struct rb_script *script, int line, const char *name)
{
	const struct rb_scene *const scene = script->scene;
	const char *at = script->source_file < scene->file_count
	                         ? scene->files[script->source_file].text
	                         : "";

	for (int k = 1; k < line && *at; k++) {
		at += strcspn(at, "\n");
		at += *at == '\n';
	}
	const char *const end = at + strcspn(at, "\n");
	while ((at = strstr(at, "_G")) != NULL && at < end) {
		at += 2;
		const char *const field = at + strspn(at, " \t.[\"'");
		if (field > at && strncmp(field, name, strlen(name)) == 0)
			return true;
	}
	return false;
}

void rb_globals_warn(lua_State *L)
{
	const struct rb_script *const script = rb_script_of(L);

	lua_pushglobaltable(L);
	for (int k = 0; k < script->undefined_count; k++) {
		const struct rb_undefined *const undefined = &script->undefined[k];
		char place[256];

		lua_pushstring(L, undefined->name);
		if (lua_rawget(L, -2) == LUA_TNIL && /* not `n = n or 1` */
		    (undefined->helper[0] ||
		     !names_table(script, undefined->line, undefined->name)))
			rb_log(RB_LOG_WARNING, "%snothing assigns the global '%s'%s; it is nil%s",
			       rb_error_place(script->source, undefined->line, place, sizeof place),
			       undefined->name, undefined->helper, undefined->hint);
		lua_pop(L, 1);
	}
	lua_pop(L, 1);
}

void rb_globals_explain(const struct rb_script *script, struct rb_error *err)
{
	static const char mark[] = "a nil value (global '";
	const struct rb_scene *const scene = script->scene;
	const char *const found = strstr(err->text, mark);

	if (!found)
		return;
	const char *const name = found + sizeof mark - 1;
	const size_t size = strcspn(name, "'"), used = strlen(err->text);
	for (int i = 0; i < scene->body_count; i++) {
		const char *const body = scene->bodies[i].name;
		if (body && strlen(body) == size && memcmp(body, name, size) == 0) {
			snprintf(err->text + used, sizeof err->text - used,
			         " (body \"%s\" gives the body of that name)", body);
			return;
		}
	}
}
