/* SPDX-License-Identifier: MIT */
/*
 * Joints as a scene sees them: one handle per joint, the same one wherever the joint turns up. What
 * it shows is the moment of script/moment.
 */
#ifndef RB_SCRIPT_JOINT_HANDLES_H
#define RB_SCRIPT_JOINT_HANDLES_H

#include "script/script.h"

/* The handles' metatable. */
void rb_joint_handles_open(lua_State *L);

/* Pushes the handle of a joint. */
void rb_joint_handle_push(lua_State *L, int joint);

/* What a kind calls its free coordinate, and the most that its motor exerts: "angle" and "torque",
 * "way" and "force"; NULL: it has none. */
const char *rb_joint_way_name(int kind);
const char *rb_joint_max_name(int kind);

#endif
