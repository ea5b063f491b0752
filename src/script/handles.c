/* SPDX-License-Identifier: MIT */
/*
 * Reading asks script/moment; changing is allowed only in callbacks that may change bodies.
 */
#include "script/handles.h"

#include <math.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "math/quat.h"
#include "model/validate.h"
#include "script/call.h"
#include "script/displaced.h"
#include "script/handle_kind.h"
#include "script/moment.h"
#include "script/vector.h"

static const struct rb_handle_kind kind;

void rb_handle_push(lua_State *L, int id)
{
	rb_handle_kind_push(L, &kind, id);
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

static const struct rb_handle_field fields[] = {
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
	const int id = rb_handle_kind_change(L, &kind, method);

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
	const int id = rb_handle_kind_self(L, &kind, "point_velocity");
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
	const int id = rb_handle_kind_self(L, &kind, "point_acceleration");
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

/* A velocity of the kind that scenes may give a body (model/validate). */
static rb_vec3 speed_check(lua_State *L, const char *what)
{
	const rb_vec3 v = rb_vector_check(L, 2, what);

	if (!isfinite(4 * rb_vec3_dot(v, v)))
		luaL_error(L,
		           "%s: too fast (got {%f, %f, %f}, wanted a speed whose square a double "
		           "holds)",
		           what, v.x, v.y, v.z);
	return v;
}

static int l_set_velocity(lua_State *L)
{
	const int id = body_to_change(L, "set_velocity");

	rb_world_set_velocity(rb_script_of(L)->world, id, speed_check(L, "set_velocity"));
	return 0;
}

static int l_set_angular_velocity(lua_State *L)
{
	const int id = body_to_change(L, "set_angular_velocity");

	rb_world_set_angular_velocity(rb_script_of(L)->world, id,
	                              speed_check(L, "set_angular_velocity"));
	return 0;
}

static int l_set_position(lua_State *L)
{
	const int id = body_to_change(L, "set_position");
	const rb_vec3 position = rb_vector_check(L, 2, "set_position");

	rb_displaced_note(L, id, "set_position");
	rb_world_set_position(rb_script_of(L)->world, id, position);
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

static const char *label_of(const struct rb_scene *scene, int id, char out[96])
{
	return rb_scene_body_label(scene, id, out);
}

static const struct rb_handle_kind kind = {.word = "body",
                                           .type = RB_HANDLE_TYPE,
                                           .key = "rbsim.handles",
                                           .field = fields,
                                           .field_count = FIELD_COUNT,
                                           .method = methods,
                                           .order = 1,
                                           .label = label_of};

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

static int l_penetration_tolerance(lua_State *L)
{
	(void)rb_moment_numbers(L, "penetration_tolerance",
	                        true); /* raises where there is no world */
	lua_pushnumber(L, rb_world_tolerance(rb_script_of(L)->world));
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
	                                 {"penetration_tolerance", l_penetration_tolerance},
	                                 {NULL, NULL}};

	rb_handle_kind_open(L, &kind);
	lua_pushglobaltable(L);
	luaL_setfuncs(L, world, 0);
	lua_pop(L, 1);
}
