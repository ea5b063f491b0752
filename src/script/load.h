/* SPDX-License-Identifier: MIT */
/*
 * A scene's file to a struct rb_scene, and the script that stays behind it.
 *
 * The script owns the Lua state with the scene's callbacks; whoever loaded it destroys it, after
 * the last call into it and after the world that uses its hooks. One thread at a time: the main
 * thread while it loads, the simulator's while a run goes on.
 */
#ifndef RB_SCRIPT_LOAD_H
#define RB_SCRIPT_LOAD_H

#include <rbsim/model.h>
#include <rbsim/scene.h>

#include "script/types.h"

struct rb_script;

/*
 * Fills `scene`, which the caller releases, whatever comes of it. On a mistake of the scene
 * RB_ERR_SCENE with every mistake found in `mistakes` (one line each; `err` has the first), and
 * what was read so far in `scene`: expect_refused and params, for one. RB_ERR_USAGE where all
 * mistakes are of `params`; RB_ERR_INPUT where the file can't be read.
 * `*script` is made even then, to be asked for its traceback and destroyed; NULL only without
 * memory for it.
 */
RB_CHECKED enum rb_status rb_script_load(struct rb_script **script, struct rb_scene *scene,
                                         struct rb_mistakes *mistakes,
                                         const struct rb_script_options *options,
                                         struct rb_error *err);
/*
 * Runs another file after the scene, in the same Lua state, that may only add cameras (`render
 * --with`): the scene's globals are there, and body "NAME" gives a handle. Its cameras come after
 * those of the scene. Errors as for rb_script_load, with the name of this file; the scene is as
 * before where there are any.
 */
RB_CHECKED enum rb_status rb_script_add_cameras(struct rb_script *script, const char *path,
                                                struct rb_mistakes *mistakes, struct rb_error *err);
void rb_script_destroy(struct rb_script *script); /* NULL is fine */

/*
 * Whether a text may be the value of a parameter of this scene, by the rules for values of the
 * command line: type, range, choices. RB_ERR_USAGE says what was wanted. Needs no script; any
 * thread.
 */
RB_CHECKED enum rb_status rb_script_check_param(const struct rb_scene *scene, const char *name,
                                                const char *text, struct rb_error *err);

/* Lua's traceback of the last runtime error, "" when there was none. Holds until the next call into
 * the script. */
const char *rb_script_traceback(const struct rb_script *script);

/* What this was built with: "gcc 12.2.0, Lua 5.4.4". */
void rb_build_text(char *out, size_t size);

#endif
