/* SPDX-License-Identifier: MIT */
/*
 * What a scene finds of Lua's own library: math, string, table, utf8, coroutine and the harmless
 * part of the basic functions. Different from Lua:
 *   - pairs and next go through whole numbers, other numbers and texts in ascending order, then
 *     false, true, bodies and materials in the order of the scene; keys that are tables or
 *     functions have no order that holds from run to run: two of them are an error;
 *   - tostring numbers tables and functions in the order in which they were first shown, there
 *     are no addresses;
 *   - math.random is f(seed, stream, index), math.randomseed(x) chooses the stream;
 *   - functions that work in C charge the budget; the handler of xpcall is called after the
 *     error has unwound;
 *   - no string.dump, no collectgarbage, no load, no __gc.
 * A trusted script has everything, with the same order and the same random numbers.
 */
#ifndef RB_SCRIPT_LIBRARY_H
#define RB_SCRIPT_LIBRARY_H

#include <lua.h>

/* In protected mode, once per state. Leaves the stack as it was. */
void rb_library_open(lua_State *L);

/* tostring without addresses: pushes the text of the value at `index`. */
const char *rb_library_text(lua_State *L, int index, size_t *size);

#endif
