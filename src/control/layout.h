/* SPDX-License-Identifier: MIT */
/*
 * Which part of a screen is what, by its size. Values, any thread.
 */
#ifndef RB_CONTROL_LAYOUT_H
#define RB_CONTROL_LAYOUT_H

#include <stdbool.h>

/* Columns and rows, from the upper left corner. Without columns or rows it is not shown. */
typedef struct {
	int x, y, width, height;
} rb_area;

enum { RB_LAYOUT_WIDTH_MIN = 40, RB_LAYOUT_HEIGHT_MIN = 12 };

struct rb_layout {
	bool fits;         /* else only a line that says so */
	rb_area transport; /* time, speed, frame, state */
	rb_area picture;
	rb_area numbers, charts, body; /* beside the picture */
	rb_area timeline, log, bottom;
};

struct rb_layout rb_layout_of(int width, int height);

#endif
