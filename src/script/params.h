/* SPDX-License-Identifier: MIT */
/* param: a scene's parameters, their values from the command line. */
#ifndef RB_SCRIPT_PARAMS_H
#define RB_SCRIPT_PARAMS_H

#include "script/script.h"

/* param as a global. */
void rb_params_open(lua_State *L);

/*
 * After the script ran: notes the parameters given on the command line that are malformed, and
 * those that it never declared although it came to its end (`whole`).
 */
void rb_params_check(struct rb_script *script, bool whole);

/* rb_script_check_param. */
RB_CHECKED enum rb_status rb_params_check_value(const struct rb_scene *scene, const char *name,
                                                const char *text, struct rb_error *err);

#endif
