/* SPDX-License-Identifier: MIT */
/*
 * A scene's callbacks and expectations, called while a world runs and at its end.
 *
 * All calls come from the thread that owns the world. An error in a callback is RB_ERR_SCENE with
 * `file:line: what`; the traceback is then to be had from rb_script_traceback.
 */
#ifndef RB_SCRIPT_HOOKS_H
#define RB_SCRIPT_HOOKS_H

#include <rbsim/world.h>

#include "script/types.h"

struct rb_script; /* script/load */
struct lua_State;

/* on_step, on_frame, on_collision, on_transition as globals. */
void rb_hooks_open(struct lua_State *L);

/*
 * To hand to rb_world_create; members are NULL where the scene has no such callback or function.
 * Borrows the script.
 */
struct rb_world_hooks rb_script_hooks(struct rb_script *script);

/* on_frame, then every expect_always; call it for each recorded frame, frame 0 included. Costs
 * nothing where the scene has neither. */
RB_CHECKED enum rb_status rb_script_on_frame(struct rb_script *script, struct rb_world *world,
                                             double time_s, uint64_t frame, struct rb_error *err);

/* At the end of the run: calls every `expect`, and tells how every `expect_always` went. `results`
 * has room for scene->expect_count, in the order of the scene. A failed expectation is not an error
 * here. One whose function raises an error or returns something else counts as failed, with that
 * message; the others are still called, and the status is RB_ERR_SCENE with the first such error.
 */
RB_CHECKED enum rb_status rb_script_expects(struct rb_script *script, struct rb_world *world,
                                            struct rb_expect_result *results, struct rb_error *err);

/*
 * The scene's probes at this moment, [probe_count] in its order; before rb_script_on_frame, which
 * may change bodies. And its results, [result_count], at the end of the run: those from the first
 * one on whose function fails are NAN, and the status is RB_ERR_SCENE. Both cost nothing where the
 * scene has none.
 */
RB_CHECKED enum rb_status rb_script_probes(struct rb_script *script, struct rb_world *world,
                                           double *values, struct rb_error *err);
RB_CHECKED enum rb_status rb_script_results(struct rb_script *script, struct rb_world *world,
                                            double *values, struct rb_error *err);

#endif
