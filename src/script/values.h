/* SPDX-License-Identifier: MIT */
/* Single values of a scene, checked as their row says. */
#ifndef RB_SCRIPT_VALUES_H
#define RB_SCRIPT_VALUES_H

#include "script/call.h"

/* Reads the value at `index` as a row wants it into `place`; false: a mistake was noted and `place`
 * is as it was. Texts are borrowed from the value. */
bool rb_call_value(struct rb_call *call, const struct rb_row *row, int index, void *place);

/* The material that the value at `index` is or names; -1: none, a mistake was noted that begins
 * with `what`. */
int rb_call_material(struct rb_call *call, const char *what, int index);

/* A path that can't leave the folder it is in: relative, without "..". */
bool rb_path_stays(const char *path);

/* Whether a file can be read beside the scene, and is there in truth: not behind a link that leads
 * out. */
bool rb_file_beside_scene(const struct rb_script *script, const char *path);

#endif
