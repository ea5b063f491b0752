/* SPDX-License-Identifier: MIT */
/*
 * A picture in memory: 8 bits each of red, green, blue (sRGB, not premultiplied) and alpha, top row
 * first.
 *
 * Owned by whoever made it. One thread at a time.
 */
#ifndef RB_FILM_PIXMAP_H
#define RB_FILM_PIXMAP_H

#include <stdint.h>

#include <rbsim/error.h>

struct rb_pixmap {
	int width, height; /* pixels */
	uint8_t *rgba;     /* [height][width][4]; owned unless it is said to be borrowed */
};

/* Opaque black. Fails on memory only. */
RB_CHECKED enum rb_status rb_pixmap_init(struct rb_pixmap *pixmap, int width, int height,
                                         struct rb_error *err);
void rb_pixmap_release(struct rb_pixmap *pixmap); /* safe on a zeroed one and on one released */

#endif
