/* SPDX-License-Identifier: MIT */
/* world, material, contact_pair, record: a call's table to the scene. */
#ifndef RB_SCRIPT_BIND_H
#define RB_SCRIPT_BIND_H

#include <lua.h>

/* Everything that a scene can call while it is loaded, as globals. */
void rb_bind_open(lua_State *L);

#endif
