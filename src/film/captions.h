/* SPDX-License-Identifier: MIT */
/*
 * Texts that a scene writes over its pictures: labels above bodies, lines anywhere. One thread,
 * like the overlay.
 */
#ifndef RB_FILM_CAPTIONS_H
#define RB_FILM_CAPTIONS_H

#include "film/overlay.h"
#include "film/view.h"

struct rb_captions;

/* Whether the camera has any. */
bool rb_captions_wanted(const struct rb_camera_def *camera);
/*
 * Model, camera and `overlay`, which has letters of the usual size, are borrowed. RB_ERR_MEMORY,
 * RB_ERR_MISSING: no font.
 */
RB_CHECKED enum rb_status rb_captions_create(struct rb_captions **captions,
                                             const struct rb_model *model,
                                             const struct rb_camera_def *camera,
                                             struct rb_overlay *overlay, struct rb_error *err);
void rb_captions_destroy(struct rb_captions *captions); /* NULL is fine */

/*
 * Writes them all. `shot` has what functions say (NULL: there are none); `line` is the first free
 * one at the upper left corner.
 */
void rb_captions_draw(struct rb_captions *captions, const struct rb_frame *frame,
                      const struct rb_frame_shot *shot, const struct rb_view *view,
                      struct rb_pixmap *picture, int line);

#endif
