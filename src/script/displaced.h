/* SPDX-License-Identifier: MIT */
/*
 * Bodies that a callback sets elsewhere, and the joints that hold them. Several may be moved one
 * after the other, so joints are looked at when the callback has ended: none may be more open for
 * it than one may be at the start. Simulator's thread, within a call into Lua.
 */
#ifndef RB_SCRIPT_DISPLACED_H
#define RB_SCRIPT_DISPLACED_H

#include "script/script.h"

/* Before the world sets body `id` elsewhere; `method`: of the handle, static text. */
void rb_displaced_note(lua_State *L, int id, const char *method);
/* At the end of a callback: raises an error for the first joint that was opened. */
void rb_displaced_check(lua_State *L);

#endif
