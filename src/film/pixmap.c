/* SPDX-License-Identifier: MIT */
#include "film/pixmap.h"

#include "base/error.h"
#include "base/memory.h"

enum rb_status rb_pixmap_init(struct rb_pixmap *pixmap, int width, int height, struct rb_error *err)
{
	*pixmap = (struct rb_pixmap){0};
	RB_ASSERT(width > 0 && height > 0);
	const size_t count = (size_t)width * (size_t)height;
	uint8_t *rgba = rb_memory_take(count, 4);
	if (!rgba)
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot hold a picture of %d x %d pixels: out of memory", width,
		               height);
	for (size_t k = 0; k < count; k++)
		rgba[4 * k + 3] = 255;
	*pixmap = (struct rb_pixmap){.width = width, .height = height, .rgba = rgba};
	return RB_OK;
}

void rb_pixmap_release(struct rb_pixmap *pixmap)
{
	rb_memory_free(pixmap->rgba);
	*pixmap = (struct rb_pixmap){0};
}
