/* SPDX-License-Identifier: MIT */
/*
 * Vectors for scenes: `vec3(x, y, z)` is a list of three numbers with operators, `.x .y .z`,
 * `:length()`, `:dot(v)`,
 * `:cross(v)` and `:unit()`. Wherever one is taken, {x, y, z} will do.
 */
#ifndef RB_SCRIPT_VECTOR_H
#define RB_SCRIPT_VECTOR_H

#include <stdbool.h>

#include <lua.h>

#include <rbsim/math.h>

#define RB_VECTOR_TYPE "rbsim.vec3" /* their metatable's name */

/* vec3 and deg as globals. */
void rb_vector_open(lua_State *L);

void rb_vector_push(lua_State *L, rb_vec3 v);

/* `count` numbers in a list at `index`, and nothing else in it, by raw access; false and
 * *count_found (may be NULL) otherwise. They may be infinite or not numbers in the sense of IEEE
 * 754. */
bool rb_vector_numbers(lua_State *L, int index, int count, double *values, int *count_found);

/* What is wrong with an orientation. */
enum rb_turn {
	RB_TURN_RIGHT,
	RB_TURN_NO_LIST, /* neither {w, x, y, z} nor {axis = , angle = } */
	RB_TURN_NOT_FINITE,
	RB_TURN_NOT_UNIT, /* further than 1e-3 from unit length */
	RB_TURN_NO_AXIS   /* an axis without length */
};
struct rb_turn_found {
	bool by_axis;
	double numbers[4]; /* w, x, y, z, or the axis and the angle */
};
/* The table at `index` as a unit quaternion, by raw access. */
enum rb_turn rb_vector_turn(lua_State *L, int index, rb_quat *value, struct rb_turn_found *found);

/* Argument `index` as a finite vector, or a Lua error that says what it must be; `what` names the
 * call. */
rb_vec3 rb_vector_check(lua_State *L, int index, const char *what);

#endif
