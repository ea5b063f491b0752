/* SPDX-License-Identifier: MIT */
/*
 * Pictures of one camera with all that belongs in them: what the painter draws, trails, overlay.
 * One thread.
 */
#ifndef RB_FILM_TAKE_H
#define RB_FILM_TAKE_H

#include "film/painter.h"

struct rb_take;

/* Whether pictures of the camera have texts, for which a font is needed. */
bool rb_take_writes(const struct rb_camera_def *camera);

RB_CHECKED enum rb_status rb_take_create(struct rb_take **take, const struct rb_model *model,
                                         const struct rb_camera_def *camera, struct rb_error *err);
void rb_take_destroy(struct rb_take *take);                      /* NULL is fine; same thread */
void rb_take_heed(struct rb_take *take, const atomic_bool *cut); /* as rb_painter_heed */

/* Every frame before one that is drawn, in order of time, drawn or not: trails grow by it. */
void rb_take_see(struct rb_take *take, const struct rb_frame *frame);

/* The picture at a frame; as rb_painter_draw, with the overlay. */
RB_CHECKED enum rb_status rb_take_draw(struct rb_take *take, const struct rb_frame *frame,
                                       const struct rb_frame_shot *shot, struct rb_pixmap *picture,
                                       struct rb_error *err);
struct rb_painter_times rb_take_times(const struct rb_take *take);

#endif
