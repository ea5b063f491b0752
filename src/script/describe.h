/* SPDX-License-Identifier: MIT */
/* What a value is, for messages. Owns nothing. */
#ifndef RB_SCRIPT_DESCRIBE_H
#define RB_SCRIPT_DESCRIBE_H

#include <lua.h>

/* Metatables of what scenes get from us; script/handles, joint_handles and bind make them. */
#define RB_HANDLE_TYPE "rbsim.body"
#define RB_JOINT_TYPE "rbsim.joint"
#define RB_MATERIAL_TYPE "rbsim.material"

/*
 * Number of entries of the table at `index`, whose keys are 1, 2, ..., by raw access; -1: it is no
 * table or has other keys too, which a reader of a list would drop.
 */
long long rb_list_length(lua_State *L, int index);

/* What was found, for "(got ...)": a number, the text 'x', a table ... Returns `out`. */
const char *rb_describe(lua_State *L, int index, char out[80]);

#endif
