/* SPDX-License-Identifier: MIT */
/*
 * The type of a parameter is that of its default, so a text of the command line can be read without
 * being told more. A value is checked at two times: while the scene runs, against Lua's values, and
 * for a restart of a run, by rb_params_check_value, when there is no script: then against the texts
 * that the scene's definition keeps.
 */
#include "script/params.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "base/memory.h"
#include "script/fields.h"
#include "script/nearest.h"
#include "script/sandbox.h"

/*
 * TEXT_MAX: of a value in messages and definitions of numbers; texts of a scene are kept whole.
 * NAMES_MAX: of the list of parameters in a message.
 */
enum { TEXT_MAX = 256, NAMES_MAX = 512 };

/* Writes a value as the scene would: the shortest digits that read back as the same number. */
static void value_text(lua_State *L, int index, char out[TEXT_MAX])
{
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		if (lua_isinteger(L, index)) {
			snprintf(out, TEXT_MAX, "%lld", (long long)lua_tointeger(L, index));
			break;
		}
		for (int digits = 15; digits <= 17; digits++) {
			snprintf(out, TEXT_MAX, "%.*g", digits, lua_tonumber(L, index));
			if (strtod(out, NULL) == lua_tonumber(L, index))
				break;
		}
		break;
	case LUA_TBOOLEAN:
		snprintf(out, TEXT_MAX, "%s", lua_toboolean(L, index) ? "true" : "false");
		break;
	default:
		snprintf(out, TEXT_MAX, "%.200s", lua_tostring(L, index));
		break;
	}
}

/* The type that a default has. */
static enum rb_param_type type_of(lua_State *L, int index)
{
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		return lua_isinteger(L, index) ? RB_PARAM_INTEGER : RB_PARAM_NUMBER;
	case LUA_TBOOLEAN:
		return RB_PARAM_BOOLEAN;
	default:
		return RB_PARAM_TEXT;
	}
}

/* What the command line has for a name, the last one; NULL: nothing. */
static const char *given_text(const struct rb_script_options *options, const char *name)
{
	const size_t size = strlen(name);

	for (int i = options->param_count - 1; i >= 0; i--)
		if (strncmp(options->params[i], name, size) == 0 && options->params[i][size] == '=')
			return options->params[i] + size + 1;
	return NULL;
}

/*
 * Pushes the value that a text stands for; false with nothing pushed: it cannot be read as that
 * type.
 */
static bool push_given(lua_State *L, enum rb_param_type type, const char *text)
{
	lua_Integer whole;

	switch (type) {
	case RB_PARAM_TEXT:
		lua_pushstring(L, text);
		return true;
	case RB_PARAM_BOOLEAN:
		if (strcmp(text, "true") != 0 && strcmp(text, "false") != 0)
			return false;
		lua_pushboolean(L, text[0] == 't');
		return true;
	case RB_PARAM_INTEGER:
	case RB_PARAM_NUMBER:
	default:
		break;
	}
	if (lua_stringtonumber(L, text) == 0)
		return false;
	const lua_Number number = lua_tonumber(L, -1);
	if (type == RB_PARAM_INTEGER) {
		int is_whole;
		whole = lua_tointegerx(L, -1, &is_whole);
		lua_pop(L, 1);
		if (!is_whole)
			return false;
		lua_pushinteger(L, whole);
		return true;
	}
	lua_pop(L, 1);
	if (!isfinite(number))
		return false;
	lua_pushnumber(L, number);
	return true;
}

/*
 * Notes a mistake in a value: of the command line, which has a status of its own, or of the scene's
 * default.
 */
static void value_mistake(struct rb_call *call, bool from_command_line, const char *name,
                          const char *wanted, const char *found)
{
	if (from_command_line) {
		call->script->usage_mistake_count++;
		rb_script_mistake(call->script, 0, "--param %s: must be %s (got '%.60s')", name,
		                  wanted, found);
	} else {
		rb_call_mistake(call, "the default must be %s (got %.60s)", wanted, found);
	}
}

/* Whether the value at `index` is in the list of choices at `list`. */
static bool is_chosen(lua_State *L, int index, int list)
{
	const lua_Integer count = (lua_Integer)lua_rawlen(L, list);
	bool found = false;

	for (lua_Integer i = 1; i <= count && !found; i++) {
		lua_rawgeti(L, list, i);
		found = lua_compare(L, index, -1, LUA_OPEQ);
		lua_pop(L, 1);
	}
	return found;
}

/*
 * Pushes "a, b, c" for the list of choices on top of the stack; false: it is none, a mistake was
 * noted.
 */
static bool push_choices(struct rb_call *call)
{
	lua_State *L = call->L;
	const int list = lua_gettop(L);
	const long long count = rb_list_length(L, list);
	bool right = count > 0;
	char text[TEXT_MAX];
	luaL_Buffer all;

	for (lua_Integer i = 1; i <= count && right; i++) {
		const int type = lua_rawgeti(L, list, i);
		right = type == LUA_TNUMBER || type == LUA_TSTRING || type == LUA_TBOOLEAN;
		lua_pop(L, 1);
	}
	if (!right) {
		rb_call_mistake(call,
		                "'choices' must be a list of numbers, texts or booleans (got %s)",
		                rb_describe(L, list, text));
		return false;
	}
	luaL_buffinit(L, &all);
	for (lua_Integer i = 1; i <= count; i++) {
		lua_rawgeti(L, list, i);
		value_text(L, -1, text);
		lua_pop(L, 1);
		luaL_addstring(&all, i > 1 ? ", " : "");
		luaL_addstring(&all, text);
	}
	luaL_pushresult(&all);
	return true;
}

/* A parameter's range in words; at least one bound is given. */
static const char *range_text(const struct rb_param_def *def, char out[TEXT_MAX])
{
	RB_ASSERT(!(isnan(def->min) && isnan(def->max)));
	if (isnan(def->max))
		snprintf(out, TEXT_MAX, "at least %.12g", def->min);
	else if (isnan(def->min))
		snprintf(out, TEXT_MAX, "at most %.12g", def->max);
	else
		snprintf(out, TEXT_MAX, "in [%.12g, %.12g]", def->min, def->max);
	return out;
}

/*
 * Checks range and choices of the value at `index`; false: a mistake was noted. `list`: index of
 * the choices, 0: none.
 */
static bool allowed(struct rb_call *call, const struct rb_param_def *def, int index, int list,
                    bool from_command_line)
{
	char text[TEXT_MAX], wanted[TEXT_MAX];

	value_text(call->L, index, text);
	if (def->type == RB_PARAM_NUMBER || def->type == RB_PARAM_INTEGER) {
		const double value = lua_tonumber(call->L, index);
		if (value < def->min || value > def->max) {
			value_mistake(call, from_command_line, def->name, range_text(def, wanted),
			              text);
			return false;
		}
	}
	if (list && !is_chosen(call->L, index, list)) {
		snprintf(wanted, sizeof wanted, "one of %.200s", def->choices);
		value_mistake(call, from_command_line, def->name, wanted, text);
		return false;
	}
	return true;
}

/*
 * Checks arguments 1 to 4: name, default, help, what is allowed. False: a mistake that leaves
 * nothing to go on with.
 */
static bool check_arguments(struct rb_call *call)
{
	lua_State *L = call->L;
	char found[80];
	size_t size;

	if (lua_type(L, 1) != LUA_TSTRING) {
		rb_call_mistake(call,
		                "expected a name, a default, a help text (got %s for the name)",
		                rb_describe(L, 1, found));
		return false;
	}
	const char *name = lua_tolstring(L, 1, &size);
	if (size == 0 || strlen(name) != size || strchr(name, '=')) {
		rb_call_mistake(call, "a name must not be empty nor hold '=' (got '%.60s')", name);
		return false;
	}
	const int type = lua_type(L, 2);
	if (type != LUA_TNUMBER && type != LUA_TBOOLEAN && type != LUA_TSTRING) {
		rb_call_mistake(call, "the default must be a number, a boolean or a text (got %s)",
		                rb_describe(L, 2, found));
		return false;
	}
	if (type == LUA_TSTRING && strlen(lua_tostring(L, 2)) != lua_rawlen(L, 2)) {
		rb_call_mistake(call, "the default must not hold a zero byte");
		return false;
	}
	if (type == LUA_TNUMBER && !isfinite(lua_tonumber(L, 2))) {
		rb_call_mistake(call, "the default must be finite (got %s)",
		                rb_describe(L, 2, found));
		return false;
	}
	if (!lua_isnil(L, 3) && lua_type(L, 3) != LUA_TSTRING)
		rb_call_mistake(call, "the help must be a text (got %s)", rb_describe(L, 3, found));
	rb_sandbox_charge(L, (uint64_t)call->script->scene->param_count);
	for (int i = 0; i < call->script->scene->param_count; i++)
		if (strcmp(call->script->scene->params[i].name, name) == 0)
			rb_call_mistake(call, "the parameter was declared before");
	return true;
}

/* What a text that cannot be read as the type should have been. */
static void type_text(lua_State *L, enum rb_param_type type, const char *default_text,
                      const char *given, char out[TEXT_MAX])
{
	static const char *const names[] = {"a number", "a whole number", "true or false",
	                                    "a text"};

	if (type != RB_PARAM_INTEGER || lua_stringtonumber(L, given) == 0) {
		snprintf(out, TEXT_MAX, "%s", names[type]);
		return;
	}
	lua_pop(L, 1);
	snprintf(out, TEXT_MAX,
	         "a whole number, as its default %.40s is one (write %.40s.0 in the scene for any "
	         "number)",
	         default_text, default_text);
}

static int l_param(lua_State *L)
{
	char default_text[TEXT_MAX], text[TEXT_MAX], wanted[TEXT_MAX];
	int list = 0;

	lua_settop(L, 4);
	struct rb_call call = rb_call_begin(L, "param", &rb_rows_param, lua_isnil(L, 4) ? 0 : 4);
	if (lua_type(L, 1) == LUA_TSTRING)
		snprintf(call.label, sizeof call.label, "param '%.60s'", lua_tostring(L, 1));
	if (!check_arguments(&call)) {
		lua_pushvalue(L, 2);
		return 1;
	}
	struct rb_param_def def = {.name = lua_tostring(L, 1),
	                           .help = lua_type(L, 3) == LUA_TSTRING ? lua_tostring(L, 3) : "",
	                           .type = type_of(L, 2),
	                           .min = (double)NAN,
	                           .max = (double)NAN};
	rb_call_read(&call, &def);
	if ((rb_call_given(&call, "min") || rb_call_given(&call, "max")) &&
	    def.type != RB_PARAM_NUMBER && def.type != RB_PARAM_INTEGER)
		rb_call_mistake(&call, "'min' and 'max' are for numbers");
	if (def.min > def.max) {
		rb_call_mistake(&call, "'min' %.9g is above 'max' %.9g", def.min, def.max);
		def.min = def.max = (double)NAN; /* told once */
	}
	if (rb_call_push(&call, "choices") != LUA_TNIL && push_choices(&call)) {
		list = lua_gettop(L) - 1;
		def.choices = lua_tostring(L, -1);
	}

	bool right = allowed(&call, &def, 2, list, false);
	const char *given = given_text(call.script->options, def.name);
	lua_pushvalue(L, 2);
	if (given && push_given(L, def.type, given)) {
		if (right && allowed(&call, &def, lua_gettop(L), list, true))
			lua_remove(L, -2);
		else
			lua_pop(L, 1);
	} else if (given) {
		value_text(L, 2, text);
		type_text(L, def.type, text, given, wanted);
		value_mistake(&call, true, def.name, wanted, given);
	}
	value_text(L, 2, default_text);
	value_text(L, -1, text);
	/* texts whole: a recording runs again with what it says */
	const bool is_text = def.type == RB_PARAM_TEXT;
	def.default_text = is_text ? lua_tostring(L, 2) : default_text;
	def.value_text = is_text ? lua_tostring(L, -1) : text;
	def.value = lua_type(L, -1) == LUA_TBOOLEAN ? lua_toboolean(L, -1) : lua_tonumber(L, -1);

	struct rb_error err;
	rb_sandbox_charge_bytes(L, sizeof def + strlen(def.help) + lua_rawlen(L, 1) +
	                                   strlen(def.default_text) + strlen(def.value_text));
	rb_script_need(L, rb_scene_add_param(call.script->scene, &def, &err), &err);
	return 1;
}

/* "; it has e, n and 3 more": ten names at most. */
static void name_params(const struct rb_scene *scene, char out[NAMES_MAX])
{
	enum { MOST = 10 };
	const int count = scene->param_count < MOST ? scene->param_count : MOST;
	int used = snprintf(out, NAMES_MAX, "; it has %s", count ? "" : "none");

	for (int i = 0; i < count; i++)
		used += snprintf(out + used, NAMES_MAX - (size_t)used, "%s%.40s", i > 0 ? ", " : "",
		                 scene->params[i].name);
	if (scene->param_count > count)
		snprintf(out + used, NAMES_MAX - (size_t)used, " and %d more",
		         scene->param_count - count);
}

void rb_params_check(struct rb_script *script, bool whole)
{
	const struct rb_script_options *options = script->options;
	const struct rb_scene *scene = script->scene;

	for (int i = 0; i < options->param_count; i++) {
		const char *given = options->params[i];
		char name[64], hint[96], names[NAMES_MAX];
		const size_t size = strcspn(given, "=");
		snprintf(name, sizeof name, "%.*s", (int)(size < 60 ? size : 60), given);
		if (given[size] != '=' || size == 0) {
			script->usage_mistake_count++;
			rb_script_mistake(script, 0, "--param '%s': expected NAME=VALUE", name);
			continue;
		}
		struct rb_nearest nearest = rb_nearest_to(name);
		bool known = !whole;
		for (int k = 0; k < scene->param_count && !known; k++) {
			known = strlen(scene->params[k].name) == size &&
			        strncmp(scene->params[k].name, given, size) == 0;
			rb_nearest_offer(&nearest, scene->params[k].name,
			                 strlen(scene->params[k].name));
		}
		if (known)
			continue;
		script->usage_mistake_count++;
		name_params(scene, names);
		rb_script_mistake(script, 0, "--param %s: the scene has no such parameter%s%s",
		                  name, rb_nearest_hint(&nearest, hint), names);
	}
}

/* ---- values that are set while a run goes on ---- */

/* lua_Alloc over base/memory. With block NULL, old_size is a kind of object. */
static void *give_memory(void *user, void *block, size_t old_size, size_t size)
{
	(void)user;
	if (size == 0) {
		rb_memory_free(block);
		return NULL;
	}
	return rb_memory_grow(block, block ? old_size : 0, size, 1);
}

/*
 * Whether "a, b, c" has a value; values are as value_text writes them. One that holds ", " itself
 * may be found across two choices, which is not worth a parser.
 */
static bool listed(const char *choices, const char *value)
{
	const size_t size = strlen(value);

	for (const char *at = choices; (at = strstr(at, value)); at++) {
		const bool begins = at == choices || (at >= choices + 2 && at[-2] == ',');
		if (begins && (at[size] == '\0' || strncmp(at + size, ", ", 2) == 0))
			return true;
	}
	return false;
}

/*
 * Checks a text as a parameter's value. A Lua state of its own reads it: what a number is, Lua
 * says. Nothing here can raise an error.
 */
static enum rb_status check_value(lua_State *L, const struct rb_param_def *def, const char *text,
                                  struct rb_error *err)
{
	char value[TEXT_MAX], wanted[TEXT_MAX];
	const bool is_number = def->type == RB_PARAM_NUMBER || def->type == RB_PARAM_INTEGER;

	snprintf(value, sizeof value, "%s", text);
	wanted[0] = '\0';
	if (def->type != RB_PARAM_TEXT && !push_given(L, def->type, text))
		type_text(L, def->type, def->default_text, text, wanted);
	else if (def->type != RB_PARAM_TEXT)
		value_text(L, -1, value);
	if (!wanted[0] && is_number &&
	    (lua_tonumber(L, -1) < def->min || lua_tonumber(L, -1) > def->max))
		range_text(def, wanted);
	if (!wanted[0] && def->choices && !listed(def->choices, value))
		snprintf(wanted, sizeof wanted, "one of %.200s", def->choices);
	if (!wanted[0])
		return RB_OK;
	return RB_FAIL(err, RB_ERR_USAGE, "parameter '%.60s' must be %s (got '%.60s')", def->name,
	               wanted, text);
}

enum rb_status rb_params_check_value(const struct rb_scene *scene, const char *name,
                                     const char *text, struct rb_error *err)
{
	const struct rb_param_def *def = NULL;
	struct rb_nearest nearest = rb_nearest_to(name);
	char hint[96], names[NAMES_MAX];

	for (int i = 0; i < scene->param_count && !def; i++) {
		if (strcmp(scene->params[i].name, name) == 0)
			def = &scene->params[i];
		rb_nearest_offer(&nearest, scene->params[i].name, strlen(scene->params[i].name));
	}
	if (!def) {
		name_params(scene, names);
		return RB_FAIL(err, RB_ERR_USAGE, "the scene has no parameter '%.60s'%s%s", name,
		               rb_nearest_hint(&nearest, hint), names);
	}
	lua_State *const L = rb_lua_new(give_memory, NULL);
	if (!L)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot check parameter '%.60s': out of memory",
		               name);
	const enum rb_status status = check_value(L, def, text, err);
	lua_close(L);
	return status;
}

void rb_params_open(lua_State *L)
{
	lua_register(L, "param", l_param);
}
