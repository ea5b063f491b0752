/* SPDX-License-Identifier: MIT */
/* spring, drag and field: forces between bodies and on all of them, from a call to the scene. */
#ifndef RB_SCRIPT_FORCE_CALLS_H
#define RB_SCRIPT_FORCE_CALLS_H

#include "script/script.h"

/* Their calls, as globals. */
void rb_forces_open(lua_State *L);

#endif
