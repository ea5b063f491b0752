/* SPDX-License-Identifier: MIT */
/*
 * Bodies as a scene sees them: one handle per body, the same one wherever the body turns up.
 *
 * What it shows is the moment of script/moment.
 */
#ifndef RB_SCRIPT_HANDLES_H
#define RB_SCRIPT_HANDLES_H

#include "script/script.h"

/* The handles' metatable, and the functions of the world: time, energy, ... */
void rb_handles_open(lua_State *L);

/* Pushes the handle of a body. */
void rb_handle_push(lua_State *L, int id);

#endif
