/* SPDX-License-Identifier: MIT */
#include "script/force_calls.h"

#include <lauxlib.h>

#include "model/validate.h"
#include "script/call.h"
#include "script/fields.h"

/* A key that must be there. Where one is misspelt it may be this one: one message is enough. */
static void want(struct rb_call *call, const char *key)
{
	if (!call->unknown && !rb_call_tried(call, key))
		rb_call_mistake(call, "'%s' is missing", key);
}

static int l_spring(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "spring", &rb_rows_spring, 1);
	struct rb_spring_def def = rb_spring_def_default();
	struct rb_scene *scene = call.script->scene;
	struct rb_error err;

	if (call.index == 0)
		return 0;
	def.line = call.line;
	rb_call_read(&call, &def);
	want(&call, "a");
	want(&call, "b");
	want(&call, "stiffness");
	if (!rb_call_given(&call, "a") || !rb_call_given(&call, "b"))
		return 0;
	const char *fault = rb_spring_fault(scene, &def);
	if (fault)
		rb_call_mistake(&call, "%s", fault);
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_spring(scene, &def, &err), &err);
	return 0;
}

static int l_drag(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "drag", &rb_rows_drag, 1);
	struct rb_drag_def def = {0};
	struct rb_error err;

	if (call.index == 0)
		return 0;
	def.line = call.line;
	rb_call_read(&call, &def);
	if (!call.unknown && !rb_call_tried(&call, "linear") && !rb_call_tried(&call, "quadratic"))
		rb_call_mistake(&call, "wants 'linear', 'quadratic' or both");
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_drag(call.script->scene, &def, &err), &err);
	return 0;
}

static int l_field(lua_State *L)
{
	const struct rb_call call = rb_call_begin(L, "field", NULL, 0);
	struct rb_error err;
	char found[80];

	if (lua_type(L, 1) != LUA_TFUNCTION) {
		rb_call_mistake(&call, "wants a function of t, x and v (got %s)",
		                rb_describe(L, 1, found));
		return 0;
	}
	const struct rb_field_def def = {.function = rb_script_keep_function(L, 1),
	                                 .line = call.line};
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_field(call.script->scene, &def, &err), &err);
	return 0;
}

void rb_forces_open(lua_State *L)
{
	lua_register(L, "spring", l_spring);
	lua_register(L, "drag", l_drag);
	lua_register(L, "field", l_field);
}
