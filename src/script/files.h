/* SPDX-License-Identifier: MIT */
/* The files a scene is made of: itself, and what it requires from beside it or from the shipped
 * helpers. */
#ifndef RB_SCRIPT_FILES_H
#define RB_SCRIPT_FILES_H

#include "script/script.h"

/* The text without what Lua does not read: a byte order mark and a first line that begins with '#',
 * whose end stays. */
const char *rb_files_body(const char *text, size_t *size);

/* require as a global; the one that is there (a trusted script's) is asked where ours finds
 * nothing. */
void rb_files_open(lua_State *L);

#endif
