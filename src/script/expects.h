/* SPDX-License-Identifier: MIT */
/* expect, expect_always, expect_refused, reference: taken from the scene, judged and remembered. */
#ifndef RB_SCRIPT_EXPECTS_H
#define RB_SCRIPT_EXPECTS_H

#include "script/script.h"

/* Their calls, as globals. */
void rb_expects_open(lua_State *L);

/* The two values on top of the stack, which an expectation's function returned, into `result`; a
 * Lua error where they are neither a boolean nor measured and bound. */
void rb_expect_judge(lua_State *L, const struct rb_expect_def *def,
                     struct rb_expect_result *result);

/* What an expect_always gave at one frame. */
void rb_expect_remember(struct rb_expect_state *state, const struct rb_expect_result *now,
                        double time_s);
struct rb_expect_result rb_expect_recall(const struct rb_expect_state *state,
                                         const struct rb_expect_def *def);

#endif
