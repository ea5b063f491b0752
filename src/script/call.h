/* SPDX-License-Identifier: MIT */
/*
 * One call of a scene's and the mistakes in it. A mistake is noted with the scene's line and the
 * call's name, and loading goes on, so that one pass finds them all.
 */
#ifndef RB_SCRIPT_CALL_H
#define RB_SCRIPT_CALL_H

#include <stdbool.h>
#include <stdint.h>

#include "script/describe.h"
#include "script/rows.h"
#include "script/script.h"

/* On the stack of the C function that serves it. Owns nothing. */
struct rb_call {
	lua_State *L;
	struct rb_script *script;
	const struct rb_row_table *table;
	int index;       /* of its table of keys; 0: there is none */
	int values;      /* that stand there before the keys, without one */
	int line;        /* in the scene's own file, 0: unknown */
	char label[128]; /* "sphere 'ball'" */
	char helper[80]; /* " (in rbsim.pile:33)", "" when the scene itself called */
	uint64_t given;  /* bit k: row k of the table was given, and right */
	uint64_t wrong;  /* given, and wrong */
	int unknown;     /* keys that no row knows */
};

/* Starts to serve `word`, whose table of keys is argument `index` (0: it has none). Notes a mistake
 * when it is no table; raises an error when nothing is being loaded. */
struct rb_call rb_call_begin(lua_State *L, const char *word, const struct rb_row_table *table,
                             int index);

/* An entry of a list of a call, like the second of its texts ("": of a list without a name), at the
 * same place in the scene; it has no table of keys. */
struct rb_call rb_call_entry(const struct rb_call *call, const char *list, int number);

/* A part of a call, like the second of its forces, or its motor (`number` 0: there is but one): its
 * own table at `index`, the same place in the scene. */
struct rb_call rb_call_part(const struct rb_call *call, const struct rb_row_table *table, int index,
                            int number);

/* file:line: label: what. */
void rb_call_mistake(const struct rb_call *call, const char *format, ...) RB_PRINTF(2, 3);

/* file:line: what, or file: what for line 0. */
void rb_script_mistake(struct rb_script *script, int line, const char *format, ...) RB_PRINTF(3, 4);

/* The line of the scene's own file that is being run (0: none), and the helper that it called (may
 * be NULL). */
int rb_scene_line(lua_State *L, char *helper, size_t helper_size);

/* A body's id from a handle; -1: it is none. */
int rb_handle_id(lua_State *L, int index);

#endif
