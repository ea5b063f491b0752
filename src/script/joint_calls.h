/* SPDX-License-Identifier: MIT */
/* joint: what holds two bodies together, from a call to the scene. */
#ifndef RB_SCRIPT_JOINT_CALLS_H
#define RB_SCRIPT_JOINT_CALLS_H

#include "script/script.h"

/* Its call, as a global. */
void rb_joints_open(lua_State *L);

#endif
