/* SPDX-License-Identifier: MIT */
/* Single values of a scene, checked as their row says. */
#ifndef RB_SCRIPT_VALUES_H
#define RB_SCRIPT_VALUES_H

#include "script/call.h"

/* Reads the value at `index` as a row wants it into `place`; false: a mistake was noted and `place`
 * is as it was. Texts are borrowed from the value. */
bool rb_call_value(struct rb_call *call, const struct rb_row *row, int index, void *place);

/*
 * Whether the value at `index` is a list of flags that begins with "+": it adds to what is there.
 */
bool rb_flags_add(lua_State *L, int index);

/* The material that the value at `index` is or names; -1: none, a mistake was noted that begins
 * with `what`. */
int rb_call_material(struct rb_call *call, const char *what, int index);

/*
 * Notes what the value at `index` must be; false, for the caller to return. A row without a key is
 * that of an entry of a list, which the call's label names.
 */
bool rb_call_wrong(struct rb_call *call, const struct rb_row *row, int index, const char *wanted);

/* Place of the text at `index` among the row's choices; -1: a mistake was noted. */
int rb_call_choice(struct rb_call *call, const struct rb_row *row, int index);

/* Id of the body of that name so far; -1: none, and `hint` tells the nearest. */
int rb_body_named(lua_State *L, const char *name, char hint[96]);

#endif
