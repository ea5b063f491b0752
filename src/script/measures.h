/* SPDX-License-Identifier: MIT */
/*
 * result and probe: a scene's own numbers, taken from the scene and asked for.
 *
 * A function returns one number. NaN stands for "no value": it is recorded, and left out wherever a
 * smallest or largest value is told; infinities are values. Anything else that is returned is an
 * error of the scene.
 */
#ifndef RB_SCRIPT_MEASURES_H
#define RB_SCRIPT_MEASURES_H

#include "script/script.h"

/* Their calls, as globals. */
void rb_measures_open(lua_State *L);

/*
 * In protected mode: calls the function of a measure (`kind`: "result" or "probe") and gives its
 * number; a Lua error where it returns none.
 */
double rb_measure_ask(lua_State *L, const struct rb_measure_def *def, const char *kind);

#endif
