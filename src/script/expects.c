/* SPDX-License-Identifier: MIT */
#include "script/expects.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "script/call.h"

/* ---- while loading ---- */

/* Serves expect and expect_always. */
static int add_expect(lua_State *L, const char *word, bool always)
{
	const struct rb_call call = rb_call_begin(L, word, NULL, 0);
	struct rb_scene *scene = call.script->scene;
	struct rb_error err;
	char found[80];

	if (lua_type(L, 1) != LUA_TSTRING || lua_type(L, 2) != LUA_TFUNCTION) {
		rb_call_mistake(&call, "expected a text and a function (got %s%s)",
		                rb_describe(L, lua_type(L, 1) != LUA_TSTRING ? 1 : 2, found),
		                lua_type(L, 1) != LUA_TSTRING ? " for the text"
		                                              : " for the function");
		return 0;
	}
	const struct rb_expect_def def = {.text = lua_tostring(L, 1),
	                                  .line = call.line,
	                                  .always = always,
	                                  .function = rb_script_keep_function(L, 2)};
	rb_sandbox_charge_bytes(L, sizeof def + sizeof(struct rb_expect_state) + lua_rawlen(L, 1));
	rb_script_need(L, rb_scene_add_expect(scene, &def, &err), &err);
	if (always)
		scene->hooks |= RB_HOOK_EXPECT_ALWAYS;
	return 0;
}

static int l_expect(lua_State *L)
{
	return add_expect(L, "expect", false);
}

static int l_expect_always(lua_State *L)
{
	return add_expect(L, "expect_always", true);
}

/* expect_refused(status, pattern): the exit status that the scene must end with, and what the
 * message must show. */
static int l_expect_refused(lua_State *L)
{
	static const int statuses[] = {64, 65, 66, 69, 73, 74, 76};
	const struct rb_call call = rb_call_begin(L, "expect_refused", NULL, 0);
	struct rb_scene *scene = call.script->scene;
	char found[80];
	int whole = 0;
	const lua_Integer status = lua_tointegerx(L, 1, &whole);
	bool known = false;

	for (size_t i = 0; i < sizeof statuses / sizeof *statuses; i++)
		known = known || (whole && statuses[i] == status);
	if (lua_type(L, 1) != LUA_TNUMBER || !known) {
		rb_call_mistake(&call,
		                "expected an exit status of rbsim(1) first, like 65 (got %s)",
		                rb_describe(L, 1, found));
		return 0;
	}
	if (!lua_isnoneornil(L, 2) && lua_type(L, 2) != LUA_TSTRING) {
		rb_call_mistake(&call, "expected a pattern as a text (got %s)",
		                rb_describe(L, 2, found));
		return 0;
	}
	scene->expect_refused = (int)status;
	if (lua_type(L, 2) == LUA_TSTRING) {
		rb_sandbox_charge_bytes(L, lua_rawlen(L, 2));
		scene->expect_refused_pattern = rb_scene_text(scene, lua_tostring(L, 2));
		if (!scene->expect_refused_pattern)
			rb_script_need(L, RB_ERR_MEMORY, NULL);
	}
	return 0;
}

/* reference(f): kept for those who measure against it; gives f back, so that expects can use it. */
static int l_reference(lua_State *L)
{
	const struct rb_call call = rb_call_begin(L, "reference", NULL, 0);
	char found[80];

	if (lua_type(L, 1) != LUA_TFUNCTION) {
		rb_call_mistake(&call, "expected a function of t (got %s)",
		                rb_describe(L, 1, found));
		return 0;
	}
	lua_settop(L, 1);
	lua_pushvalue(L, 1);
	lua_setfield(L, LUA_REGISTRYINDEX, "rbsim.reference");
	return 1;
}

void rb_expects_open(lua_State *L)
{
	lua_register(L, "expect", l_expect);
	lua_register(L, "expect_always", l_expect_always);
	lua_register(L, "expect_refused", l_expect_refused);
	lua_register(L, "reference", l_reference);
	lua_newtable(L);
	lua_setglobal(L, "state");
}

/* ---- while running ---- */

/* NAN without a sign: 0/0 has one on some processors, and it would be printed. */
static double plain_nan(double x)
{
	return isnan(x) ? (double)NAN : x;
}

void rb_expect_judge(lua_State *L, const struct rb_expect_def *def, struct rb_expect_result *result)
{
	const char *file = rb_script_of(L)->scene->file;
	const int first = lua_type(L, -2), second = lua_type(L, -1);

	RB_ASSERT(result != NULL);
	if (first == LUA_TBOOLEAN && second == LUA_TNIL) {
		result->ok = lua_toboolean(L, -2);
		if (!result->ok)
			snprintf(result->message, sizeof result->message, "is false");
	} else if (first == LUA_TNUMBER && second == LUA_TNUMBER) {
		result->has_numbers = true;
		result->measured = plain_nan(lua_tonumber(L, -2));
		result->bound = plain_nan(lua_tonumber(L, -1));
		result->ok = result->measured <= result->bound; /* false for what is not a number */
		if (!result->ok)
			snprintf(result->message, sizeof result->message,
			         "measured %.9g, bound %.9g", result->measured, result->bound);
	} else {
		char found[2][80];
		luaL_error(L,
		           "%s:%d: %s '%s': the function must return a boolean, or measured and "
		           "bound (got %s and %s)",
		           file, def->line, def->always ? "expect_always" : "expect", def->text,
		           rb_describe(L, -2, found[0]), rb_describe(L, -1, found[1]));
	}
}

/* How far a value is beyond its bound; what is not a number is as far as can be. */
static double excess(double measured, double bound)
{
	const double difference = measured - bound;

	return isnan(difference) ? (double)INFINITY : difference;
}

void rb_expect_remember(struct rb_expect_state *state, const struct rb_expect_result *now,
                        double time_s)
{
	/* the worst frame is the one that is reported */
	if (now->has_numbers &&
	    (!state->has_numbers ||
	     excess(now->measured, now->bound) > excess(state->measured, state->bound))) {
		state->has_numbers = true;
		state->measured = now->measured;
		state->bound = now->bound;
	}
	state->seen = true;
	if (now->ok || state->failed)
		return;
	state->failed = true;
	state->failed_s = time_s;
	snprintf(state->message, sizeof state->message, "at t = %.9g s: %.120s", time_s,
	         now->message);
}

struct rb_expect_result rb_expect_recall(const struct rb_expect_state *state,
                                         const struct rb_expect_def *def)
{
	struct rb_expect_result result = {.text = def->text,
	                                  .line = def->line,
	                                  .always = true,
	                                  .ok = state->seen && !state->failed,
	                                  .has_numbers = state->has_numbers,
	                                  .measured = state->measured,
	                                  .bound = state->bound,
	                                  .failed_s = state->failed ? state->failed_s
	                                                            : (double)NAN};

	snprintf(result.message, sizeof result.message, "%s",
	         state->failed ? state->message
	         : state->seen ? ""
	                       : "no frame was looked at");
	return result;
}
