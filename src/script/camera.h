/* SPDX-License-Identifier: MIT */
/* camera: parsed, checked and kept in the scene; what it asks for is drawn by a renderer where
 * there is one. */
#ifndef RB_SCRIPT_CAMERA_H
#define RB_SCRIPT_CAMERA_H

#include <lua.h>

/* camera as a global. */
void rb_camera_open(lua_State *L);

#endif
