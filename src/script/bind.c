/* SPDX-License-Identifier: MIT */
/*
 * Each call reads its keys into a copy of the present definition and puts it into the scene only
 * when it is the only one of its kind. Mistakes are noted and loading goes on; only what leaves
 * nothing to go on with raises a Lua error.
 */
#include "script/bind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "script/body_calls.h"
#include "script/camera.h"
#include "script/fields.h"
#include "script/force_calls.h"
#include "script/handles.h"
#include "script/joint_calls.h"
#include "script/joint_handles.h"
#include "script/nearest.h"
#include "script/params.h"
#include "script/values.h"
#include "script/vector.h"

/* ---- world, record ---- */

/*
 * A copy of the text that lives as long as the scene; NULL stays NULL. Charged to the script's
 * memory.
 */
static const char *keep_text(struct rb_call *call, const char *text)
{
	if (!text)
		return NULL;
	rb_sandbox_charge_bytes(call->L, strlen(text));
	const char *copy = rb_scene_text(call->script->scene, text);
	if (!copy)
		rb_script_need(call->L, RB_ERR_MEMORY, NULL);
	return copy;
}

/*
 * Notes the call; false with a mistake noted if there was one before. -1 stands for a line that is
 * not known.
 */
static bool only_call(struct rb_call *call, int *first_line)
{
	if (*first_line != 0) {
		rb_call_mistake(call, "called twice (first on line %d)", *first_line);
		return false;
	}
	*first_line = call->line ? call->line : -1;
	return true;
}

/* Reads `gravitation`. */
static void read_gravitation(struct rb_call *call, struct rb_gravitation_def *def)
{
	if (rb_call_push(call, "gravitation") != LUA_TNIL) {
		struct rb_call part = rb_call_part(call, &rb_rows_gravitation, -1, 0);

		def->given = true;
		rb_call_read(&part, def);
	}
	lua_pop(call->L, 1);
}

static int l_world(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "world", &rb_rows_world, 1);
	struct rb_script *script = call.script;
	struct rb_world_def world = script->scene->world;

	rb_call_read(&call, &world);
	read_gravitation(&call, &world.gravitation);
	for (int i = 0; i < rb_rows_world.count; i++)
		if (rb_call_given(&call, rb_rows_world.rows[i].key))
			script->world_given |= UINT64_C(1) << i;
	if (rb_call_given(&call, "duration") && rb_call_given(&call, "steps"))
		rb_call_mistake(&call, "'duration' and 'steps' exclude each other");
	if (!only_call(&call, &script->world_line))
		return 0;
	world.title = keep_text(&call, world.title);
	world.description = keep_text(&call, world.description);
	if (script->options->has_seed)
		world.seed = script->options->seed;
	/* numbers drawn before would be those of another seed */
	else if (rb_call_given(&call, "seed") && script->sandbox.random_used &&
	         world.seed != script->sandbox.seed)
		rb_call_mistake(&call, "'seed' must come before the first random number is drawn");
	script->sandbox.seed = world.seed;
	world.line = call.line;
	script->scene->world = world;
	return 0;
}

static int l_record(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "record", &rb_rows_record, 1);
	struct rb_record_def record = call.script->scene->record;

	if (call.index > 0) {
		lua_pushliteral(L, "ledger");
		record.ledger_given = lua_rawget(L, call.index) != LUA_TNIL;
		lua_pushliteral(L, "fields");
		record.fields_given = lua_rawget(L, call.index) != LUA_TNIL &&
		                      !rb_flags_add(L, lua_absindex(L, -1));
		lua_pop(L, 2);
	}
	rb_call_read(&call, &record);
	if (record.fields & RB_FIELD_SURFACES)
		record.fields |= RB_FIELD_SURFACES_NEED;
	if (!only_call(&call, &call.script->record_line))
		return 0;
	record.file = keep_text(&call, record.file);
	call.script->scene->record = record;
	return 0;
}

/* ---- material, contact_pair ---- */

static int l_material(lua_State *L)
{
	struct rb_call call = rb_call_begin(L, "material", &rb_rows_material, 1);
	struct rb_material_def def = rb_material_def_default();
	struct rb_error err;
	int index;

	rb_call_read(&call, &def);
	rb_name_take(&call, "material", def.name);
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_material(call.script->scene, &def, &index, &err), &err);
	int *handle = lua_newuserdatauv(L, sizeof *handle, 0);
	*handle = index;
	luaL_setmetatable(L, RB_MATERIAL_TYPE);
	return 1;
}

static int l_material_index(lua_State *L)
{
	const int *handle = luaL_checkudata(L, 1, RB_MATERIAL_TYPE);
	const struct rb_material_def *material = &rb_script_of(L)->scene->materials[*handle];
	const char *key = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";
	static const char *const keys[] = {"name", "density", "friction", "restitution"};
	char hint[96];

	if (strcmp(key, "name") == 0) {
		lua_pushstring(L, material->name);
	} else if (strcmp(key, "density") == 0) {
		lua_pushnumber(L, material->density);
	} else if (strcmp(key, "friction") == 0) {
		lua_pushnumber(L, material->friction);
	} else if (strcmp(key, "restitution") == 0) {
		lua_pushnumber(L, material->restitution);
	} else {
		struct rb_nearest nearest = rb_nearest_to(key);
		for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
			rb_nearest_offer(&nearest, keys[i], strlen(keys[i]));
		return luaL_error(L, "a material has no field '%s'%s", key,
		                  rb_nearest_hint(&nearest, hint));
	}
	return 1;
}

static int l_material_newindex(lua_State *L)
{
	return luaL_error(L, "a material can't be changed: make another one");
}

static int l_material_tostring(lua_State *L)
{
	const int *handle = luaL_checkudata(L, 1, RB_MATERIAL_TYPE);
	const char *name = rb_script_of(L)->scene->materials[*handle].name;

	lua_pushfstring(L, name ? "material '%s'" : "material", name);
	return 1;
}

static int l_contact_pair(lua_State *L)
{
	lua_settop(L, 3);
	struct rb_call call = rb_call_begin(L, "contact_pair", &rb_rows_contact_pair, 3);
	struct rb_contact_pair_def def = {.friction = (double)NAN, .restitution = (double)NAN};
	struct rb_scene *scene = call.script->scene;
	struct rb_error err;

	def.material_a = rb_call_material(&call, "the first", 1);
	def.material_b = rb_call_material(&call, "the second", 2);
	rb_call_read(&call, &def);
	if (def.material_a < 0 || def.material_b < 0)
		return 0;
	/* the search is linear, so a scene pays for it */
	rb_sandbox_charge(L, (uint64_t)scene->contact_pair_count);
	for (int i = 0; i < scene->contact_pair_count; i++) {
		const struct rb_contact_pair_def *other = &scene->contact_pairs[i];
		if ((other->material_a == def.material_a && other->material_b == def.material_b) ||
		    (other->material_a == def.material_b && other->material_b == def.material_a)) {
			rb_call_mistake(&call, "these two materials have an entry already");
			return 0;
		}
	}
	rb_sandbox_charge_bytes(L, sizeof def);
	rb_script_need(L, rb_scene_add_contact_pair(scene, &def, &err), &err);
	return 0;
}

void rb_bind_open(lua_State *L)
{
	static const luaL_Reg calls[] = {{"world", l_world},
	                                 {"record", l_record},
	                                 {"material", l_material},
	                                 {"contact_pair", l_contact_pair},
	                                 {NULL, NULL}};
	static const luaL_Reg material[] = {{"__index", l_material_index},
	                                    {"__newindex", l_material_newindex},
	                                    {"__tostring", l_material_tostring},
	                                    {NULL, NULL}};

	luaL_newmetatable(L, RB_MATERIAL_TYPE);
	luaL_setfuncs(L, material, 0);
	lua_pushinteger(L, 2);
	lua_setfield(L, -2, "__order");
	lua_pushliteral(L, "material");
	lua_setfield(L, -2, "__metatable");
	lua_pop(L, 1);
	lua_pushglobaltable(L);
	luaL_setfuncs(L, calls, 0);
	lua_pop(L, 1);
	rb_vector_open(L);
	rb_handles_open(L);
	rb_bodies_open(L);
	rb_forces_open(L);
	rb_joint_handles_open(L);
	rb_joints_open(L);
	rb_camera_open(L);
	rb_params_open(L);
}
