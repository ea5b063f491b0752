/* SPDX-License-Identifier: MIT */
/* string.find, match, gmatch and gsub over script/pattern, so that what they work through counts.
 */
#ifndef RB_SCRIPT_STRINGS_H
#define RB_SCRIPT_STRINGS_H

#include <lua.h>

/* Into the table on top of the stack. */
void rb_strings_open(lua_State *L);

#endif
