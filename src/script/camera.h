/* SPDX-License-Identifier: MIT */
/* camera: parsed, checked and kept in the scene; what it asks for is drawn by a renderer where
 * there is one. */
#ifndef RB_SCRIPT_CAMERA_H
#define RB_SCRIPT_CAMERA_H

#include <stdbool.h>

#include <lua.h>

/* Pictures have no more pixels a side. */
enum { RB_CAMERA_SIDE_MAX = 16384 };

/* Frames of pictures are numbered by one %d, as in printf: "frames/%05d.png". */
bool rb_camera_is_numbered(const char *pattern);

/* The names that are taken become those of the scene's cameras as they are now. */
void rb_camera_names(lua_State *L);

/* camera as a global. */
void rb_camera_open(lua_State *L);

#endif
