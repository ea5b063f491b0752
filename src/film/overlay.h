/* SPDX-License-Identifier: MIT */
/*
 * Text over a finished picture: title, time, energy, drawn with FreeType.
 *
 * An overlay belongs to one thread. The font is the first of RBSIM_FONT (a file) and the usual
 * places of DejaVu Sans; RB_ERR_MISSING names what was looked for when there is none.
 */
#ifndef RB_FILM_OVERLAY_H
#define RB_FILM_OVERLAY_H

#include <stdbool.h>

#include "film/pixmap.h"

struct rb_overlay;

/*
 * For pictures of that size: letters are a fixed part of the height, or of that of 16:9 where they
 * are narrower.
 */
RB_CHECKED enum rb_status rb_overlay_create(struct rb_overlay **overlay, int width_px,
                                            int height_px, struct rb_error *err);
void rb_overlay_destroy(struct rb_overlay *overlay); /* NULL is fine */

enum rb_overlay_corner {
	RB_OVERLAY_TOP_LEFT,
	RB_OVERLAY_TOP_RIGHT,
	RB_OVERLAY_BOTTOM_LEFT,
	RB_OVERLAY_BOTTOM_RIGHT
};

/*
 * One line of UTF-8, readable on any background (light letters with a soft dark rim, blended in
 * linear light), at a corner of the picture; a line that is too long for it is cut with an
 * ellipsis. Digits keep their places from picture to picture (tabular figures). `line` counts from
 * the corner inwards.
 */
void rb_overlay_write(struct rb_overlay *overlay, struct rb_pixmap *pixmap,
                      enum rb_overlay_corner corner, int line, const char *text);

/* Width and height in px of a line that is not cut. */
struct rb_overlay_size {
	int width, height;
};
struct rb_overlay_size rb_overlay_size_of(struct rb_overlay *overlay, const char *text);
/* The same with the upper left corner of the line's box at a pixel, cut to `room` px. */
void rb_overlay_put(struct rb_overlay *overlay, struct rb_pixmap *pixmap, int x, int y, int room,
                    const char *text);

/* A thin upright line from one pixel row down to another, as readable as letters. */
void rb_overlay_stroke(struct rb_overlay *overlay, struct rb_pixmap *pixmap, int x, int upper,
                       int lower);

/* px that so many lines at an edge of the picture take of it. */
int rb_overlay_lines_px(const struct rb_overlay *overlay, int lines);

/*
 * A line of text as above, with a bar of `length_px` below it that ends where the text does: two
 * lines high.
 */
void rb_overlay_bar(struct rb_overlay *overlay, struct rb_pixmap *pixmap,
                    enum rb_overlay_corner corner, int line, int length_px, const char *text);

/* Do both have room side by side, one in a left corner and one in a right one of a picture? */
bool rb_overlay_fits(struct rb_overlay *overlay, int width_px, const char *left, const char *right);

#endif
