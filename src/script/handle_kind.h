/* SPDX-License-Identifier: MIT */
/*
 * What handles of bodies and of joints share: a userdata that holds a number and nothing else, made
 * once and kept in the registry, so that handles can be compared and be keys. Fields and methods
 * are tables by name; all else is a row of `struct rb_handle_kind`, which lives as long as the
 * program.
 */
#ifndef RB_SCRIPT_HANDLE_KIND_H
#define RB_SCRIPT_HANDLE_KIND_H

#include <lauxlib.h>

#include "script/script.h"

struct rb_handle_field {
	const char *name;
	int (*get)(lua_State *L, int id); /* pushes the value; returns how many: 1 */
	const char *instead;              /* the method that changes it; NULL: see `changed_by` */
};

struct rb_handle_kind {
	const char *word; /* "body": what messages and tostring call it */
	const char *type; /* of its metatable */
	const char *key;  /* of its handles in the registry */
	const char
		*changed_by; /* what changes fields without a method of their own; NULL: nothing */
	const struct rb_handle_field *field;
	int field_count;
	const luaL_Reg *method; /* ends with NULL */
	int order;              /* its place among types where keys are sorted (script/library) */
	const char *(*label)(const struct rb_scene *scene, int id, char out[96]);
};

/* Makes the metatable of the kind. */
void rb_handle_kind_open(lua_State *L, const struct rb_handle_kind *kind);

/* Pushes the handle of that number, the same one every time. */
void rb_handle_kind_push(lua_State *L, const struct rb_handle_kind *kind, int id);

/* Number of the handle that a method is called on, or a Lua error that says how to call it. */
int rb_handle_kind_self(lua_State *L, const struct rb_handle_kind *kind, const char *method);

/* The same in a callback that may change the world, or a Lua error that names those. */
int rb_handle_kind_change(lua_State *L, const struct rb_handle_kind *kind, const char *method);

#endif
