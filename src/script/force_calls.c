/* SPDX-License-Identifier: MIT */
/*
 * A kind of force element states its keys, defaults and checks in its row (model/element); one
 * function serves them all. The definition is read into bytes that only the kind can interpret.
 */
#include "script/force_calls.h"

#include <stddef.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "model/element.h"
#include "script/call.h"
#include "script/fields.h"

/*
 * Whether the keys that the element cannot do without are there; notes those that are missing.
 * Where one is misspelt it may be this one: one message is enough.
 */
static bool has_required(struct rb_call *call, const struct rb_element_kind *kind)
{
	bool all = true;

	for (int k = 0; k < kind->keys.count; k++) {
		const struct rb_row *key = &kind->keys.rows[k];

		if (strcmp(key->fallback, "required") != 0)
			continue;
		if (!call->unknown && !rb_call_tried(call, key->key))
			rb_call_mistake(call, "'%s' is missing", key->key);
		/* without its bodies there is nothing to check or to keep */
		all = all && (key->type != RB_ROW_BODY || rb_call_given(call, key->key));
	}
	return all;
}

/* Whether any key of the kind was tried. */
static bool has_one(const struct rb_call *call, const struct rb_element_kind *kind)
{
	for (int k = 0; k < kind->keys.count; k++)
		if (rb_call_tried(call, kind->keys.rows[k].key))
			return true;
	return false;
}

/* The call of a kind of force element, which is the function's upvalue. */
static int l_element(lua_State *L)
{
	const struct rb_element_kind *kind = lua_touserdata(L, lua_upvalueindex(1));
	struct rb_call call = rb_call_begin(L, kind->name, &kind->keys, 1);
	struct rb_scene *scene = call.script->scene;
	_Alignas(max_align_t) unsigned char row[RB_ELEMENT_ROW_MAX];
	struct rb_error err;

	RB_ASSERT(kind && kind->row_size <= RB_ELEMENT_ROW_MAX);
	if (call.index == 0)
		return 0;
	memcpy(row, kind->defaults, kind->row_size);
	memcpy(row + kind->line_at, &call.line, sizeof call.line);
	rb_call_read(&call, row);
	if (!has_required(&call, kind))
		return 0;
	if (kind->wants_one && !call.unknown && !has_one(&call, kind))
		rb_call_mistake(&call, "needs %s", kind->wants_one);
	const char *fault = rb_element_ends_fault(scene, kind, row);
	if (fault)
		rb_call_mistake(&call, "%s", fault);
	rb_sandbox_charge_bytes(L, kind->row_size);
	rb_script_need(L, rb_scene_add_element(scene, kind, row, &err), &err);
	return 0;
}

static int l_field(lua_State *L)
{
	const bool more = !lua_isnoneornil(L, 2);
	struct rb_call call = rb_call_begin(L, "field", &rb_rows_field, more ? 2 : 0);
	struct rb_error err;
	char found[80];

	if (lua_type(L, 1) != LUA_TFUNCTION) {
		rb_call_mistake(&call, "expected a function of t, x and v (got %s)",
		                rb_describe(L, 1, found));
		return 0;
	}
	struct rb_field_def def = {.function = rb_script_keep_function(L, 1), .line = call.line};
	rb_call_read(&call, &def);
	def.has_potential = rb_call_given(&call, "potential");
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_field(call.script->scene, &def, &err), &err);
	return 0;
}

void rb_forces_open(lua_State *L)
{
	for (int place = 0; place < rb_element_kind_count; place++) {
		lua_pushlightuserdata(L, (void *)(uintptr_t)rb_element_kinds[place]);
		lua_pushcclosure(L, l_element, 1);
		lua_setglobal(L, rb_element_kinds[place]->name);
	}
	lua_register(L, "field", l_field);
}
