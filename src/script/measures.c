/* SPDX-License-Identifier: MIT */
#include "script/measures.h"

#include <math.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "script/call.h"
#include "script/fields.h"

/*
 * Whether the text at `index` may name a measure: it becomes a name in HDF5, CSV and on the command
 * line.
 */
static bool is_name(lua_State *L, int index)
{
	size_t size;
	const char *const text = lua_tolstring(L, index, &size);

	if (size == 0 || size > RB_MEASURE_NAME_MAX)
		return false;
	for (size_t i = 0; i < size; i++)
		if ((unsigned char)text[i] < ' ' || text[i] == 127)
			return false;
	return true;
}

/* Whether name and function are as they must be; notes what is not. */
static bool check_arguments(const struct rb_call *call, const char *word)
{
	lua_State *L = call->L;
	char found[80];

	if (lua_type(L, 1) != LUA_TSTRING || lua_type(L, 2) != LUA_TFUNCTION) {
		const int wrong = lua_type(L, 1) != LUA_TSTRING ? 1 : 2;

		rb_call_mistake(call,
		                "wants a name and a function, like %s(\"height\", function() "
		                "return ball.position.z end, {unit = \"m\"}) (got %s for the "
		                "%s)",
		                word, rb_describe(L, wrong, found),
		                wrong == 1 ? "name" : "function");
		return false;
	}
	if (!is_name(L, 1)) {
		rb_call_mistake(call,
		                "the name must have 1 to %d bytes and no control characters "
		                "(got %s)",
		                RB_MEASURE_NAME_MAX, rb_describe(L, 1, found));
		return false;
	}
	return true;
}

/* Whether the name is new among `list`, and there is room; notes what is not. */
static bool check_list(const struct rb_call *call, const struct rb_measure_def *list, int count)
{
	for (int i = 0; i < count; i++)
		if (strcmp(list[i].name, lua_tostring(call->L, 1)) == 0) {
			rb_call_mistake(call, "there is one of that name already, in line %d",
			                list[i].line);
			return false;
		}
	if (count >= RB_MEASURES_MAX)
		rb_call_mistake(call, "more than %d of them", RB_MEASURES_MAX);
	return count < RB_MEASURES_MAX;
}

/* Serves result and probe. */
static int add_measure(lua_State *L, const char *word, bool probe)
{
	lua_settop(L, 3);
	struct rb_call call = rb_call_begin(L, word, &rb_rows_measure, lua_isnil(L, 3) ? 0 : 3);
	struct rb_scene *const scene = call.script->scene;
	struct rb_measure_def def = {.units = "", .description = "", .line = call.line};
	struct rb_error err;

	if (lua_type(L, 1) == LUA_TSTRING)
		snprintf(call.label, sizeof call.label, "%s '%.60s'", word, lua_tostring(L, 1));
	const bool right = check_arguments(&call, word);
	rb_call_read(&call, &def);
	if (strlen(def.units) > RB_MEASURE_UNITS_MAX)
		rb_call_mistake(&call, "'unit' must have at most %d bytes", RB_MEASURE_UNITS_MAX);
	if (!right || !check_list(&call, probe ? scene->probes : scene->results,
	                          probe ? scene->probe_count : scene->result_count))
		return 0;
	def.name = lua_tostring(L, 1);
	def.function = rb_script_keep_function(L, 2);
	rb_sandbox_charge_bytes(L, sizeof def + lua_rawlen(L, 1) + strlen(def.units) +
	                                   strlen(def.description));
	rb_script_need(L, rb_scene_add_measure(scene, probe, &def, &err), &err);
	return 0;
}

static int l_result(lua_State *L)
{
	return add_measure(L, "result", false);
}

static int l_probe(lua_State *L)
{
	return add_measure(L, "probe", true);
}

void rb_measures_open(lua_State *L)
{
	lua_register(L, "result", l_result);
	lua_register(L, "probe", l_probe);
}

double rb_measure_ask(lua_State *L, const struct rb_measure_def *def, const char *kind)
{
	char found[80];

	rb_script_push_function(L, def->function);
	lua_call(L, 0, 1);
	if (lua_type(L, -1) != LUA_TNUMBER)
		luaL_error(L, "%s:%d: %s '%s': the function must return a number (got %s)",
		           rb_script_of(L)->scene->file, def->line, kind, def->name,
		           rb_describe(L, -1, found));
	const double value = lua_tonumber(L, -1);
	lua_pop(L, 1);
	/* NAN without a sign, which some processors give it: recordings are the same everywhere */
	return isnan(value) ? (double)NAN : value;
}
