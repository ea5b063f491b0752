/* SPDX-License-Identifier: MIT */
/* Pictures that bodies wear: PNG files beside the scene, which become files of the scene. */
#ifndef RB_SCRIPT_TEXTURES_H
#define RB_SCRIPT_TEXTURES_H

#include "script/call.h"

/*
 * Puts the file among those of the scene, under its name, once for all that wear it; `key` is that
 * of the call. False: a mistake was noted: it is not there, not a PNG file, or has too many pixels.
 * What is behind its first bytes is left to whoever draws it.
 */
bool rb_texture_take(struct rb_call *call, const char *key, const char *name);

#endif
