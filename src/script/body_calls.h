/* SPDX-License-Identifier: MIT */
/*
 * sphere, plane, box, capsule, cylinder, hull and body: a call's table to a body of the scene, and
 * its handle back.
 */
#ifndef RB_SCRIPT_BODY_CALLS_H
#define RB_SCRIPT_BODY_CALLS_H

#include "script/call.h"

/* These as globals. */
void rb_bodies_open(lua_State *L);

/* Where the names of a kind are kept in the registry: name = line of its call. */
#define RB_NAMES_KEY "rbsim.names."

/* Notes a mistake when `name` is taken among names of one kind ("body", "material", "camera"), else
 * takes it. */
void rb_name_take(const struct rb_call *call, const char *kind, const char *name);

#endif
