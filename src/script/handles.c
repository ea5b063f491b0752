/* SPDX-License-Identifier: MIT */
/*
 * A handle is a userdata that holds an id and nothing else; it is made once and kept in the
 * registry, so that handles can be compared and be keys. Fields and methods are tables by name;
 * reading asks script/moment, and changing is allowed only in callbacks that may change bodies.
 */
#include "script/handles.h"

#include <math.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "math/quat.h"
#include "model/validate.h"
#include "script/call.h"
#include "script/moment.h"
#include "script/nearest.h"
#include "script/vector.h"

static const char handles_key[] = "rbsim.handles";

void rb_handle_push(lua_State *L, int id)
{
	RB_ASSERT(id >= 0);
	luaL_getsubtable(L, LUA_REGISTRYINDEX, handles_key);
	if (lua_rawgeti(L, -1, id + 1) == LUA_TNIL) {
		lua_pop(L, 1);
		int *handle = lua_newuserdatauv(L, sizeof *handle, 0);
		*handle = id;
		luaL_setmetatable(L, RB_HANDLE_TYPE);
		lua_pushvalue(L, -1);
		lua_rawseti(L, -3, id + 1);
	}
	lua_remove(L, -2);
}

/* Id of the body that a method is called on, or an error that says how to call it. */
static int self_id(lua_State *L, const char *method)
{
	const int id = rb_handle_id(L, 1);

	if (id < 0)
		luaL_error(L, "%s: called without its body (write body:%s(...))", method, method);
	return id;
}

/* The body's definition. */
static const struct rb_body_def *definition(lua_State *L, int id)
{
	RB_ASSERT(id >= 0 && id < rb_script_of(L)->scene->body_count);
	return &rb_script_of(L)->scene->bodies[id];
}

/* ---- fields ---- */

static int get_name(lua_State *L, int id)
{
	lua_pushstring(L, definition(L, id)->name); /* nil where there is none */
	return 1;
}

static int get_position(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_position(L, id));
	return 1;
}

static int get_orientation(lua_State *L, int id)
{
	double values[4];

	rb_quat_to(values, rb_moment_orientation(L, id));
	lua_createtable(L, 4, 0);
	for (int i = 0; i < 4; i++) {
		lua_pushnumber(L, values[i]);
		lua_rawseti(L, -2, i + 1);
	}
	return 1;
}

static int get_velocity(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_velocity(L, id));
	return 1;
}

static int get_angular_velocity(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_angular_velocity(L, id));
	return 1;
}

static int get_acceleration(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_load(L, id, "acceleration").acceleration);
	return 1;
}

static int get_angular_acceleration(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_load(L, id, "angular_acceleration").angular_acceleration);
	return 1;
}

static int get_force(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_load(L, id, "force").force);
	return 1;
}

static int get_torque(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_load(L, id, "torque").torque);
	return 1;
}

static int get_mass(lua_State *L, int id)
{
	lua_pushnumber(L, rb_moment_mass(L, id));
	return 1;
}

/* Three rows of three numbers. */
static int get_inertia(lua_State *L, int id)
{
	const rb_mat3 inertia = rb_moment_inertia(L, id);

	lua_createtable(L, 3, 0);
	for (int i = 0; i < 3; i++) {
		rb_vector_push(L, rb_vec3_from(inertia.m[i]));
		lua_rawseti(L, -2, i + 1);
	}
	return 1;
}

static int get_kinetic_energy(lua_State *L, int id)
{
	lua_pushnumber(L, rb_moment_kinetic_energy(L, id));
	return 1;
}

static int get_momentum(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_momentum(L, id));
	return 1;
}

static int get_angular_momentum(lua_State *L, int id)
{
	rb_vector_push(L, rb_moment_angular_momentum(L, id));
	return 1;
}

static int get_is_static(lua_State *L, int id)
{
	lua_pushboolean(L, definition(L, id)->is_static);
	return 1;
}

static int get_center_of_mass(lua_State *L, int id)
{
	rb_vector_push(L, definition(L, id)->center_of_mass);
	return 1;
}

/* point(p) of the body in upvalue 1: `body.point(p)` and `body:point(p)` are the same. */
static int l_point(lua_State *L)
{
	const int index = rb_handle_id(L, 1) >= 0 ? 2 : 1;
	const int *handle = lua_touserdata(L, lua_upvalueindex(1));

	rb_vector_push(L, rb_moment_point(L, *handle, rb_vector_check(L, index, "point")));
	return 1;
}

static int get_point(lua_State *L, int id)
{
	(void)id;
	lua_pushvalue(L, 1);
	lua_pushcclosure(L, l_point, 1);
	return 1;
}

static const struct field {
	const char *name;
	int (*get)(lua_State *L, int id);
	const char *instead; /* how to change it */
} fields[] = {
	{"name", get_name, NULL},
	{"position", get_position, "set_position(p)"},
	{"orientation", get_orientation, NULL},
	{"velocity", get_velocity, "set_velocity(v)"},
	{"angular_velocity", get_angular_velocity, "set_angular_velocity(w)"},
	{"mass", get_mass, NULL},
	{"inertia", get_inertia, NULL},
	{"center_of_mass", get_center_of_mass, NULL},
	{"kinetic_energy", get_kinetic_energy, NULL},
	{"momentum", get_momentum, "apply_impulse(j)"},
	{"angular_momentum", get_angular_momentum, NULL},
	{"point", get_point, NULL},
	{"static", get_is_static, NULL},
	{"acceleration", get_acceleration, "apply_force(f)"},
	{"angular_acceleration", get_angular_acceleration, "apply_torque(t)"},
	{"force", get_force, "apply_force(f)"},
	{"torque", get_torque, "apply_torque(t)"},
};
enum { FIELD_COUNT = sizeof fields / sizeof *fields };

/* ---- changes ---- */

/* Id of the body that a method changes: moving, in a callback; else an error that says why not. */
static int body_to_change(lua_State *L, const char *method)
{
	const struct rb_script *script = rb_script_of(L);
	const int id = self_id(L, method);

	if (script->phase != RB_PHASE_CHANGE || !script->world)
		luaL_error(L, "%s: only in on_step, on_frame, on_collision and on_transition",
		           method);
	if (rb_world_is_static(script->world, id)) {
		char label[64];
		luaL_error(L, "%s: body %s is static", method,
		           rb_scene_body_label(script->scene, id, label));
	}
	if (rb_body_is_driven(definition(L, id))) {
		char label[64];
		luaL_error(L, "%s: body %s is driven by its 'motion'", method,
		           rb_scene_body_label(script->scene, id, label));
	}
	return id;
}

/* Argument 3, a world position, m; left out, the centre of mass. */
static rb_vec3 point_to_push(lua_State *L, int id, const char *method)
{
	return lua_isnoneornil(L, 3) ? rb_world_center_of_mass(rb_script_of(L)->world, id)
	                             : rb_vector_check(L, 3, method);
}

static int l_apply_impulse(lua_State *L)
{
	const int id = body_to_change(L, "apply_impulse");
	const rb_vec3 impulse = rb_vector_check(L, 2, "apply_impulse");

	rb_world_apply_impulse(rb_script_of(L)->world, id, impulse,
	                       point_to_push(L, id, "apply_impulse"));
	return 0;
}

static int l_apply_force(lua_State *L)
{
	const int id = body_to_change(L, "apply_force");
	const rb_vec3 force = rb_vector_check(L, 2, "apply_force");

	rb_world_apply_force(rb_script_of(L)->world, id, force,
	                     point_to_push(L, id, "apply_force"));
	return 0;
}

static int l_apply_torque(lua_State *L)
{
	const int id = body_to_change(L, "apply_torque");

	rb_world_apply_torque(rb_script_of(L)->world, id, rb_vector_check(L, 2, "apply_torque"));
	return 0;
}

/* m/s, of a point in object coordinates. */
static int l_point_velocity(lua_State *L)
{
	const int id = self_id(L, "point_velocity");
	const rb_vec3 point = rb_vector_check(L, 2, "point_velocity");
	const rb_vec3 arm = rb_quat_rotate(rb_moment_orientation(L, id),
	                                   rb_vec3_sub(point, definition(L, id)->center_of_mass));

	rb_vector_push(L, rb_vec3_add(rb_moment_velocity(L, id),
	                              rb_vec3_cross(rb_moment_angular_velocity(L, id), arm)));
	return 1;
}

/* m/s^2, of a point in object coordinates, as it moves with the body. */
static int l_point_acceleration(lua_State *L)
{
	const int id = self_id(L, "point_acceleration");
	const rb_vec3 point = rb_vector_check(L, 2, "point_acceleration");
	const rb_vec3 arm = rb_quat_rotate(rb_moment_orientation(L, id),
	                                   rb_vec3_sub(point, definition(L, id)->center_of_mass));
	const rb_vec3 spin = rb_moment_angular_velocity(L, id);
	const struct rb_load load = rb_moment_load(L, id, "point_acceleration");
	const rb_vec3 turn = rb_vec3_add(rb_vec3_cross(load.angular_acceleration, arm),
	                                 rb_vec3_cross(spin, rb_vec3_cross(spin, arm)));

	rb_vector_push(L, rb_vec3_add(load.acceleration, turn));
	return 1;
}

static int l_set_velocity(lua_State *L)
{
	const int id = body_to_change(L, "set_velocity");

	rb_world_set_velocity(rb_script_of(L)->world, id, rb_vector_check(L, 2, "set_velocity"));
	return 0;
}

static int l_set_angular_velocity(lua_State *L)
{
	const int id = body_to_change(L, "set_angular_velocity");

	rb_world_set_angular_velocity(rb_script_of(L)->world, id,
	                              rb_vector_check(L, 2, "set_angular_velocity"));
	return 0;
}

static int l_set_position(lua_State *L)
{
	const int id = body_to_change(L, "set_position");

	rb_world_set_position(rb_script_of(L)->world, id, rb_vector_check(L, 2, "set_position"));
	return 0;
}

static const luaL_Reg methods[] = {{"apply_impulse", l_apply_impulse},
                                   {"apply_force", l_apply_force},
                                   {"apply_torque", l_apply_torque},
                                   {"point_velocity", l_point_velocity},
                                   {"point_acceleration", l_point_acceleration},
                                   {"set_velocity", l_set_velocity},
                                   {"set_angular_velocity", l_set_angular_velocity},
                                   {"set_position", l_set_position},
                                   {NULL, NULL}};

/* ---- the metatable ---- */

static int l_index(lua_State *L)
{
	const int id = self_id(L, "a field");
	char label[64], hint[96];

	if (lua_type(L, 2) != LUA_TSTRING)
		return luaL_error(L, "a body has no field %s", luaL_typename(L, 2));
	const char *key = lua_tostring(L, 2);
	lua_pushvalue(L, 2);
	const int type = lua_rawget(L, lua_upvalueindex(1));
	if (type == LUA_TNUMBER) /* the place of a field */
		return fields[lua_tointeger(L, -1)].get(L, id);
	if (type != LUA_TNIL)
		return 1;
	struct rb_nearest nearest = rb_nearest_to(key);
	for (int i = 0; i < FIELD_COUNT; i++)
		rb_nearest_offer(&nearest, fields[i].name, strlen(fields[i].name));
	for (const luaL_Reg *method = methods; method->name; method++)
		rb_nearest_offer(&nearest, method->name, strlen(method->name));
	return luaL_error(L, "body %s has no field '%s'%s",
	                  rb_scene_body_label(rb_script_of(L)->scene, id, label), key,
	                  rb_nearest_hint(&nearest, hint));
}

static int l_newindex(lua_State *L)
{
	const char *key = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";

	for (int i = 0; i < FIELD_COUNT; i++) {
		if (strcmp(fields[i].name, key) != 0)
			continue;
		if (fields[i].instead)
			return luaL_error(
				L, "a body's '%s' can't be assigned: call body:%s in a callback",
				key, fields[i].instead);
		return luaL_error(L, "a body's '%s' can't be changed", key);
	}
	return luaL_error(L, "a body has no field '%s' to assign (keep your own values in a table)",
	                  key);
}

static int l_tostring(lua_State *L)
{
	char label[64];

	lua_pushfstring(L, "body %s",
	                rb_scene_body_label(rb_script_of(L)->scene, self_id(L, "tostring"), label));
	return 1;
}

/* ---- the world ---- */

static int l_time(lua_State *L)
{
	lua_pushnumber(L, rb_moment_time(L));
	return 1;
}

static int l_energy(lua_State *L)
{
	const struct rb_frame_numbers numbers = rb_moment_numbers(L, "energy", false);

	lua_pushnumber(L, numbers.kinetic_energy + numbers.potential_energy);
	return 1;
}

static int l_momentum(lua_State *L)
{
	rb_vector_push(L, rb_moment_numbers(L, "momentum", false).momentum);
	return 1;
}

static int l_angular_momentum(lua_State *L)
{
	rb_vector_push(L, rb_moment_numbers(L, "angular_momentum", false).angular_momentum);
	return 1;
}

static int l_collisions(lua_State *L)
{
	lua_pushinteger(L, (lua_Integer)rb_moment_numbers(L, "collisions", true).collisions);
	return 1;
}

static int l_max_penetration(lua_State *L)
{
	lua_pushnumber(L, rb_moment_numbers(L, "max_penetration", true).max_penetration);
	return 1;
}

void rb_handles_open(lua_State *L)
{
	static const luaL_Reg world[] = {{"time", l_time},
	                                 {"energy", l_energy},
	                                 {"momentum", l_momentum},
	                                 {"angular_momentum", l_angular_momentum},
	                                 {"collisions", l_collisions},
	                                 {"max_penetration", l_max_penetration},
	                                 {NULL, NULL}};

	luaL_newmetatable(L, RB_HANDLE_TYPE);
	luaL_newlib(L, methods);
	for (int i = 0; i < FIELD_COUNT; i++) {
		lua_pushinteger(L, i);
		lua_setfield(L, -2, fields[i].name);
	}
	lua_pushcclosure(L, l_index, 1);
	lua_setfield(L, -2, "__index");
	lua_pushcfunction(L, l_newindex);
	lua_setfield(L, -2, "__newindex");
	lua_pushcfunction(L, l_tostring);
	lua_setfield(L, -2, "__tostring");
	lua_pushinteger(L, 1);
	lua_setfield(L, -2, "__order");
	lua_pushliteral(L, "body");
	lua_setfield(L, -2, "__metatable");
	lua_pop(L, 1);
	lua_pushglobaltable(L);
	luaL_setfuncs(L, world, 0);
	lua_pop(L, 1);
}
