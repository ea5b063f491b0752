/* SPDX-License-Identifier: MIT */
/*
 * A vector is a plain table with a metatable, not userdata: scenes write {0, 0, 1} everywhere, and
 * both must be the same thing. All access is raw, so no metamethod of the scene's runs inside of
 * ours.
 */
#include "script/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include <lauxlib.h>

#include "base/error.h"
#include "math/quat.h"
#include "script/describe.h"

void rb_vector_push(lua_State *L, rb_vec3 v)
{
	const double values[3] = {v.x, v.y, v.z};

	lua_createtable(L, 3, 0);
	for (int i = 0; i < 3; i++) {
		lua_pushnumber(L, values[i]);
		lua_rawseti(L, -2, i + 1);
	}
	luaL_setmetatable(L, RB_VECTOR_TYPE);
}

bool rb_vector_numbers(lua_State *L, int index, int count, double *values, int *count_found)
{
	int found = 0;
	bool plain = lua_type(L, index) == LUA_TTABLE;

	RB_ASSERT(count >= 0 && values);
	index = lua_absindex(L, index);
	while (plain && found <= count) {
		const int type = lua_rawgeti(L, index, found + 1);
		if (type == LUA_TNUMBER && found < count)
			values[found] = lua_tonumber(L, -1);
		lua_pop(L, 1);
		if (type != LUA_TNUMBER) {
			plain = type == LUA_TNIL;
			break;
		}
		found++;
	}
	if (count_found)
		*count_found = found;
	if (!plain || found != count)
		return false;
	/* keys beside the numbers are a mistake: {1, 2, 3, z = 4} */
	return rb_list_length(L, index) == count;
}

/* Reads {axis = {x, y, z}, angle = radians} and nothing else into the axis and the angle. */
static bool axis_and_angle(lua_State *L, int index, double numbers[4])
{
	for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
		const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
		if (strcmp(key, "axis") == 0 || strcmp(key, "angle") == 0)
			continue;
		lua_pop(L, 2);
		return false;
	}
	lua_pushliteral(L, "angle");
	const bool has_angle = lua_rawget(L, index) == LUA_TNUMBER;
	numbers[3] = lua_tonumber(L, -1);
	lua_pushliteral(L, "axis");
	lua_rawget(L, index);
	const bool has_axis = rb_vector_numbers(L, -1, 3, numbers, NULL);
	lua_pop(L, 2);
	return has_angle && has_axis;
}

enum rb_turn rb_vector_turn(lua_State *L, int index, rb_quat *value, struct rb_turn_found *found)
{
	double *const n = found->numbers;

	*found = (struct rb_turn_found){0};
	if (lua_type(L, index) != LUA_TTABLE)
		return RB_TURN_NO_LIST;
	index = lua_absindex(L, index);
	found->by_axis = lua_rawgeti(L, index, 1) == LUA_TNIL;
	lua_pop(L, 1);
	if (!(found->by_axis ? axis_and_angle(L, index, n)
	                     : rb_vector_numbers(L, index, 4, n, NULL)))
		return RB_TURN_NO_LIST;
	if (!found->by_axis) {
		const rb_quat q = rb_quat_from(n);
		const double length = rb_quat_length(q);

		if (!isfinite(length))
			return RB_TURN_NOT_FINITE;
		if (fabs(length - 1) > 1e-3)
			return RB_TURN_NOT_UNIT;
		*value = rb_quat_unit(q);
		return RB_TURN_RIGHT;
	}
	const rb_vec3 axis = rb_vec3_from(n);
	if (!rb_vec3_finite(axis) || !isfinite(n[3]))
		return RB_TURN_NOT_FINITE;
	/*
	 * smaller ones cannot be scaled to length 1 exactly enough; the comparison also refuses NAN
	 */
	if (!(rb_vec3_max_abs(axis) >= DBL_MIN))
		return RB_TURN_NO_AXIS;
	const rb_vec3 unit = rb_vec3_unit(axis, axis);
	const double s = sin(0.5 * n[3]);
	*value = rb_quat_unit((rb_quat){cos(0.5 * n[3]), s * unit.x, s * unit.y, s * unit.z});
	return RB_TURN_RIGHT;
}

/* Reads a vector; false: it is none, `v` is then not to be used. */
static bool get(lua_State *L, int index, rb_vec3 *v)
{
	double values[3] = {0};
	const bool is = rb_vector_numbers(L, index, 3, values, NULL);

	*v = (rb_vec3){values[0], values[1], values[2]};
	return is;
}

rb_vec3 rb_vector_check(lua_State *L, int index, const char *what)
{
	char found[80];
	rb_vec3 v;

	if (!get(L, index, &v))
		luaL_error(L, "%s: expected a vector {x, y, z} (got %s)", what,
		           rb_describe(L, index, found));
	if (!rb_vec3_finite(v))
		luaL_error(L, "%s: expected finite numbers (got %s)", what,
		           rb_describe(L, index, found));
	return v;
}

/* An operand of an operator, or an error that names it. */
static rb_vec3 operand(lua_State *L, int index, const char *operator)
{
	char found[80];
	rb_vec3 v;

	if (!get(L, index, &v))
		luaL_error(L, "vec3: '%s' needs two vectors (got %s)", operator,
		           rb_describe(L, index, found));
	return v;
}

static int l_vec3(lua_State *L)
{
	char found[80];
	rb_vec3 v;

	if (lua_gettop(L) == 1 && get(L, 1, &v)) {
		rb_vector_push(L, v);
		return 1;
	}
	for (int i = 1; i <= 3; i++)
		if (lua_type(L, i) != LUA_TNUMBER)
			return luaL_error(L, "vec3: expected three numbers (got %s for number %d)",
			                  rb_describe(L, i, found), i);
	rb_vector_push(L, (rb_vec3){lua_tonumber(L, 1), lua_tonumber(L, 2), lua_tonumber(L, 3)});
	return 1;
}

static int l_deg(lua_State *L)
{
	lua_pushnumber(L, luaL_checknumber(L, 1) * (3.14159265358979323846 / 180));
	return 1;
}

static int l_add(lua_State *L)
{
	rb_vector_push(L, rb_vec3_add(operand(L, 1, "+"), operand(L, 2, "+")));
	return 1;
}

static int l_sub(lua_State *L)
{
	rb_vector_push(L, rb_vec3_sub(operand(L, 1, "-"), operand(L, 2, "-")));
	return 1;
}

static int l_mul(lua_State *L)
{
	const int number = lua_type(L, 1) == LUA_TNUMBER ? 1 : 2;
	rb_vec3 v;

	if (lua_type(L, number) != LUA_TNUMBER || !get(L, 3 - number, &v))
		return luaL_error(L, "vec3: '*' needs a number and a vector (a:dot(b) and "
		                     "a:cross(b) multiply vectors)");
	rb_vector_push(L, rb_vec3_scale(lua_tonumber(L, number), v));
	return 1;
}

static int l_div(lua_State *L)
{
	rb_vec3 v;

	if (lua_type(L, 2) != LUA_TNUMBER || !get(L, 1, &v))
		return luaL_error(L, "vec3: '/' needs a vector and a number");
	const double by = lua_tonumber(L, 2);
	rb_vector_push(L, (rb_vec3){v.x / by, v.y / by, v.z / by});
	return 1;
}

static int l_unm(lua_State *L)
{
	rb_vector_push(L, rb_vec3_neg(operand(L, 1, "-")));
	return 1;
}

static int l_eq(lua_State *L)
{
	rb_vec3 a, b;

	lua_pushboolean(L,
	                get(L, 1, &a) && get(L, 2, &b) && a.x == b.x && a.y == b.y && a.z == b.z);
	return 1;
}

static int l_tostring(lua_State *L)
{
	rb_vec3 v;

	if (get(L, 1, &v))
		lua_pushfstring(L, "{%f, %f, %f}", v.x, v.y, v.z);
	else
		lua_pushliteral(L, "{a broken vec3}");
	return 1;
}

static int l_length(lua_State *L)
{
	lua_pushnumber(L, rb_vec3_length(operand(L, 1, "length")));
	return 1;
}

static int l_dot(lua_State *L)
{
	lua_pushnumber(L, rb_vec3_dot(operand(L, 1, "dot"), operand(L, 2, "dot")));
	return 1;
}

static int l_cross(lua_State *L)
{
	rb_vector_push(L, rb_vec3_cross(operand(L, 1, "cross"), operand(L, 2, "cross")));
	return 1;
}

static int l_unit(lua_State *L)
{
	const rb_vec3 v = operand(L, 1, "unit");
	const double length = rb_vec3_length(v);

	if (!(length > 0))
		return luaL_error(L, "vec3: a vector without length has no unit vector");
	rb_vector_push(L, (rb_vec3){v.x / length, v.y / length, v.z / length});
	return 1;
}

/* 1, 2, 3 for "x", "y", "z"; 0 for anything else. */
static int coordinate(lua_State *L, int index)
{
	const char *key = lua_type(L, index) == LUA_TSTRING ? lua_tostring(L, index) : "";

	return key[0] >= 'x' && key[0] <= 'z' && key[1] == '\0' ? key[0] - 'x' + 1 : 0;
}

/* Upvalue: the table of methods. */
static int l_index(lua_State *L)
{
	const int i = coordinate(L, 2);

	if (i) {
		lua_rawgeti(L, 1, i);
		return 1;
	}
	lua_pushvalue(L, 2);
	if (lua_rawget(L, lua_upvalueindex(1)) == LUA_TNIL && lua_type(L, 2) == LUA_TSTRING)
		return luaL_error(
			L, "vec3: no field '%s' (there are x, y, z, length, dot, cross, unit)",
			lua_tostring(L, 2));
	return 1;
}

static int l_newindex(lua_State *L)
{
	const int i = coordinate(L, 2);

	if (!i || lua_type(L, 3) != LUA_TNUMBER)
		return luaL_error(L, "vec3: only x, y and z can be set, to numbers");
	lua_settop(L, 3);
	lua_rawseti(L, 1, i);
	return 0;
}

void rb_vector_open(lua_State *L)
{
	static const luaL_Reg operators[] = {
		{"__add", l_add},           {"__sub", l_sub},           {"__mul", l_mul},
		{"__div", l_div},           {"__unm", l_unm},           {"__eq", l_eq},
		{"__newindex", l_newindex}, {"__tostring", l_tostring}, {NULL, NULL}};
	static const luaL_Reg methods[] = {{"length", l_length},
	                                   {"dot", l_dot},
	                                   {"cross", l_cross},
	                                   {"unit", l_unit},
	                                   {NULL, NULL}};

	luaL_newmetatable(L, RB_VECTOR_TYPE);
	luaL_setfuncs(L, operators, 0);
	luaL_newlib(L, methods);
	lua_pushcclosure(L, l_index, 1);
	lua_setfield(L, -2, "__index");
	lua_pushliteral(L, "vec3");
	lua_setfield(L, -2, "__metatable");
	lua_pop(L, 1);
	lua_register(L, "vec3", l_vec3);
	lua_register(L, "deg", l_deg);
}
