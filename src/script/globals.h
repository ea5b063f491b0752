/* SPDX-License-Identifier: MIT */
/*
 * Globals that a scene reads and that nothing assigns. Lua takes them for nil, and a key that is
 * nil is a key that is not given: `mass = mas` is quietly the mass of the default density.
 */
#ifndef RB_SCRIPT_GLOBALS_H
#define RB_SCRIPT_GLOBALS_H

#include "script/script.h"

/* From now on reads of undefined globals are noted while the scene is loaded. */
void rb_globals_watch(lua_State *L);

/* In protected mode: warns of those that are undefined now as well. */
void rb_globals_warn(lua_State *L);

/*
 * Where a message of Lua's tells of a global that is nil and a body has its name, says behind it
 * how the scene comes to that body: a name makes no global.
 */
void rb_globals_explain(const struct rb_script *script, struct rb_error *err);

#endif
