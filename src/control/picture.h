/* SPDX-License-Identifier: MIT */
/*
 * The picture of a console: the renderer's at the size of some cells, or a sketch where that can't
 * be loaded. One thread, which creates, draws and destroys.
 */
#ifndef RB_CONTROL_PICTURE_H
#define RB_CONTROL_PICTURE_H

#include "control/viewer.h"
#include "film/pixmap.h"
#include "sink/module.h"

/* Zeroed is a good start. */
struct rb_picture {
	const struct rb_film_module *film; /* NULL: it can't be loaded */
	bool looked;
	struct rb_take *take;
	struct rb_camera_def camera; /* as the take has it */
	int camera_index;
	struct rb_pixmap sketch;          /* owned */
	struct rb_pixmap drawn;           /* borrowed from the take */
	char failure[RB_ERROR_TEXT_SIZE]; /* why there is only a sketch; "" */
};

void rb_picture_release(struct rb_picture *picture);

/* What the viewer shows, `width` x `height` pixels; `pixels` is borrowed until the next call. */
RB_CHECKED enum rb_status rb_picture_draw(struct rb_picture *picture,
                                          const struct rb_viewer *viewer, int width, int height,
                                          const struct rb_pixmap **pixels, struct rb_error *err);

#endif
