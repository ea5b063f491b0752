/* SPDX-License-Identifier: MIT */
/*
 * A frame as discs and lines: what a console shows where rbsim-film.so can't be loaded. One thread.
 */
#ifndef RB_CONTROL_SKETCH_H
#define RB_CONTROL_SKETCH_H

#include "control/steer.h"
#include "film/pixmap.h"

/* `picture` has its size and pixels. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_sketch_draw(const struct rb_pixmap *picture,
                                         const struct rb_model *model,
                                         const struct rb_camera_def *camera,
                                         const struct rb_stand *stand, const struct rb_frame *frame,
                                         struct rb_error *err);

#endif
