/* SPDX-License-Identifier: MIT */
/* What a kind of joint does not have is an error that says which name it has instead. */
#include "script/joint_handles.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "model/joints.h"
#include "script/call.h"
#include "script/handle_kind.h"
#include "script/handles.h"
#include "script/moment.h"
#include "script/nearest.h"
#include "script/script.h"
#include "script/vector.h"

static const struct rb_handle_kind handle;

const char *rb_joint_way_name(int kind)
{
	return rb_joint_is_free(kind) ? rb_joint_words(kind)->name : NULL;
}

const char *rb_joint_max_name(int kind)
{
	return rb_joint_words(kind)->load;
}

void rb_joint_handle_push(lua_State *L, int joint)
{
	rb_handle_kind_push(L, &handle, joint);
}

static const struct rb_joint_def *definition(lua_State *L, int joint)
{
	RB_ASSERT(joint >= 0 && joint < rb_script_of(L)->scene->joint_count);
	return &rb_script_of(L)->scene->joints[joint];
}

/* ---- fields ---- */

static int get_name(lua_State *L, int joint)
{
	lua_pushstring(L, definition(L, joint)->name); /* nil where there is none */
	return 1;
}

static int get_kind(lua_State *L, int joint)
{
	lua_pushstring(L, rb_joint_kind_name(definition(L, joint)->kind));
	return 1;
}

static int get_a(lua_State *L, int joint)
{
	rb_handle_push(L, definition(L, joint)->a);
	return 1;
}

/* nil: the world. */
static int get_b(lua_State *L, int joint)
{
	const int b = definition(L, joint)->b;

	if (b >= 0)
		rb_handle_push(L, b);
	else
		lua_pushnil(L);
	return 1;
}

/* Raises an error where the kind has no such field. */
static void need_way(lua_State *L, int joint, const char *name)
{
	const int kind = definition(L, joint)->kind;
	const char *const own = rb_joint_words(kind)->name;
	const char *const called = rb_joint_kind_name(kind);

	if (!own)
		luaL_error(L, "a joint of kind '%s' has no '%s'", called, name);
	else if (strcmp(name, "speed") != 0 && strcmp(name, own) != 0)
		luaL_error(L, "a joint of kind '%s' has no '%s' (did you mean '%s'?)", called, name,
		           own);
}

static int push_way(lua_State *L, int joint, const char *name)
{
	need_way(L, joint, name);
	lua_pushnumber(L, rb_moment_joint(L, joint, name).angle);
	return 1;
}

static int get_angle(lua_State *L, int joint)
{
	return push_way(L, joint, "angle");
}

static int get_way(lua_State *L, int joint)
{
	return push_way(L, joint, "way");
}

static int get_length(lua_State *L, int joint)
{
	return push_way(L, joint, "length");
}

static int get_speed(lua_State *L, int joint)
{
	need_way(L, joint, "speed");
	lua_pushnumber(L, rb_moment_joint(L, joint, "speed").speed);
	return 1;
}

static int get_force(lua_State *L, int joint)
{
	rb_vector_push(L, rb_moment_joint(L, joint, "force").force);
	return 1;
}

static int get_torque(lua_State *L, int joint)
{
	rb_vector_push(L, rb_moment_joint(L, joint, "torque").torque);
	return 1;
}

static int get_released(lua_State *L, int joint)
{
	lua_pushboolean(L, rb_moment_joint(L, joint, "released").released);
	return 1;
}

static const struct rb_handle_field fields[] = {
	{"name", get_name, NULL},     {"kind", get_kind, NULL},         {"a", get_a, NULL},
	{"b", get_b, NULL},           {"angle", get_angle, NULL},       {"way", get_way, NULL},
	{"length", get_length, NULL}, {"speed", get_speed, NULL},       {"force", get_force, NULL},
	{"torque", get_torque, NULL}, {"released", get_released, NULL},
};
enum { FIELD_COUNT = sizeof fields / sizeof *fields };

/* ---- changes ---- */

/* The value on top of the stack as a number for that key, or an error. */
static double number_of(lua_State *L, const char *key)
{
	char found[80];

	const double number = lua_tonumber(L, -1);
	if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(number))
		luaL_error(L, "set_motor: '%s' must be a finite number (got %s)", key,
		           rb_describe(L, -1, found));
	return number;
}

/* What a motor is to do; NAN: as before. */
struct change {
	double speed, max, way;
	bool follows; /* `way`, NAN: the scene's function */
};

/* Is the value on top of the stack the function that the joint's motor has in the scene? */
static bool is_own_function(lua_State *L, const struct rb_joint_def *def)
{
	if (def->motor_function < 0)
		return false;
	rb_script_push_function(L, def->motor_function);
	const bool same = lua_rawequal(L, -1, -2);

	lua_pop(L, 1);
	return same;
}

/* The value on top of the stack as what the motor follows from now on. */
static void read_way(lua_State *L, const struct rb_joint_def *def, const char *key,
                     struct change *to)
{
	char found[80];

	to->follows = true;
	if (is_own_function(L, def))
		return;
	to->way = lua_tonumber(L, -1);
	if (lua_type(L, -1) != LUA_TNUMBER || !isfinite(to->way))
		luaL_error(L,
		           "set_motor: '%s' must be a finite number, or the function that the "
		           "motor has in the scene (got %s)",
		           key, rb_describe(L, -1, found));
}

/* Reads speed, or what it follows, and the most that the motor exerts; false: it names nothing. */
static bool read_motor(lua_State *L, const struct rb_joint_def *def, struct change *to)
{
	const char *const most = rb_joint_max_name(def->kind), *const way = rb_joint_way_name(
								       def->kind);
	bool any = false;
	char hint[96];

	for (lua_pushnil(L); lua_next(L, 2); lua_pop(L, 1)) {
		const char *const key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";

		any = true;
		if (strcmp(key, "speed") == 0) {
			to->speed = number_of(L, key);
		} else if (strcmp(key, most) == 0) {
			to->max = number_of(L, key);
			if (!(to->max >= 0))
				luaL_error(L, "set_motor: '%s' must be 0 or more (got %f)", key,
				           to->max);
		} else if (strcmp(key, way) == 0) {
			read_way(L, def, key, to);
		} else {
			struct rb_nearest nearest = rb_nearest_to(key);
			rb_nearest_offer(&nearest, "speed", strlen("speed"));
			rb_nearest_offer(&nearest, most, strlen(most));
			rb_nearest_offer(&nearest, way, strlen(way));
			luaL_error(L, "set_motor: unknown key '%s'%s", key,
			           rb_nearest_hint(&nearest, hint));
		}
	}
	if (to->follows && !isnan(to->speed))
		luaL_error(L, "set_motor: 'speed' and '%s' exclude each other", way);
	return any;
}

static int l_set_motor(lua_State *L)
{
	const int joint = rb_handle_kind_change(L, &handle, "set_motor");
	const struct rb_joint_def *def = definition(L, joint);
	struct change to = {.speed = (double)NAN, .max = (double)NAN, .way = (double)NAN};
	char found[80];

	if (!rb_joint_way_name(def->kind))
		return luaL_error(L, "set_motor: a joint of kind '%s' has no motor",
		                  rb_joint_kind_name(def->kind));
	if (!rb_joint_has_motor(def))
		return luaL_error(L,
		                  "set_motor: this joint has none (see the key 'motor' of joint)");
	if (lua_type(L, 2) != LUA_TTABLE)
		return luaL_error(L, "set_motor: wants a table, like {speed = 1, %s = 2} (got %s)",
		                  rb_joint_max_name(def->kind), rb_describe(L, 2, found));
	if (!read_motor(L, def, &to))
		return luaL_error(L, "set_motor: wants 'speed' or '%s', '%s', or both",
		                  rb_joint_way_name(def->kind), rb_joint_max_name(def->kind));
	rb_world_joint_set_motor(rb_script_of(L)->world, joint, to.speed, to.max);
	if (to.follows)
		rb_world_joint_follow(rb_script_of(L)->world, joint, to.way);
	return 0;
}

static int l_release(lua_State *L)
{
	const int joint = rb_handle_kind_change(L, &handle, "release");

	rb_world_joint_release(rb_script_of(L)->world, joint);
	return 0;
}

static const luaL_Reg methods[] = {
	{"set_motor", l_set_motor}, {"release", l_release}, {NULL, NULL}};

static const struct rb_handle_kind handle = {
	.word = "joint",
	.type = RB_JOINT_TYPE,
	.key = "rbsim.joints",
	.changed_by = "joint:set_motor{...} and joint:release() change a joint, in callbacks",
	.field = fields,
	.field_count = FIELD_COUNT,
	.method = methods,
	.order = 3,
	.label = rb_joint_label};

void rb_joint_handles_open(lua_State *L)
{
	rb_handle_kind_open(L, &handle);
}
