/* SPDX-License-Identifier: MIT */
/*
 * Pictures to PNG files and back, through libpng.
 */
#ifndef RB_FILM_PNG_H
#define RB_FILM_PNG_H

#include <stdbool.h>
#include <stddef.h>

#include "film/pixmap.h"

/* Larger textures are refused before anything is allocated for them. */
enum { RB_TEXTURE_SIDE_MAX = 8192 };

/* A text chunk, "Simulated time" and "1.25 s"; key 1 to 79 Latin letters, text UTF-8. */
struct rb_png_text {
	const char *key, *text;
};

/*
 * Decodes a whole PNG file in memory: any colour type and depth, to 8-bit RGBA. Nobody vouches for
 * the bytes: RB_ERR_SCENE with `name` and what is wrong (no PNG, more than RB_TEXTURE_SIDE_MAX
 * pixels a side, cut off, damaged), RB_ERR_MEMORY.
 */
RB_CHECKED enum rb_status rb_png_decode(struct rb_pixmap *pixmap, const char *name,
                                        const void *bytes, size_t size, struct rb_error *err);

/*
 * Writes the picture (alpha is left out) under another name in the same folder and renames it:
 * nobody sees half a picture. One that exists is replaced only where `how` (base/place) says so
 * (RB_ERR_CREATE otherwise). The same picture and texts give the same bytes. `texts` (may be NULL)
 * end with a key that is NULL. RB_ERR_CREATE, RB_ERR_IO. `*bytes` (may be NULL) receives the size.
 */
RB_CHECKED enum rb_status rb_png_write(const char *path, unsigned how,
                                       const struct rb_pixmap *pixmap,
                                       const struct rb_png_text *texts, size_t *bytes,
                                       struct rb_error *err);

#endif
