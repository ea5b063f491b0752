/* SPDX-License-Identifier: MIT */
/*
 * What a camera draws and writes over its picture: trails, labels, texts, arrows and diagrams.
 * Texts live as long as the call's table. While the scene is loaded; owns nothing.
 */
#ifndef RB_SCRIPT_MARKS_H
#define RB_SCRIPT_MARKS_H

#include "script/call.h"

/* Fills these parts of `def` from the keys of a camera, and notes mistakes. */
void rb_marks_read(struct rb_call *call, struct rb_camera_def *def);

#endif
