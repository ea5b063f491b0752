/* SPDX-License-Identifier: MIT */
/*
 * Diagrams in a picture: a quantity against time, which grows with the film. One thread, like the
 * overlay.
 */
#ifndef RB_FILM_CURVES_H
#define RB_FILM_CURVES_H

#include "film/overlay.h"

#include <rbsim/frame.h>
#include <rbsim/model.h>

struct rb_curves;

/* Of a camera that has plots. Model and camera are borrowed. RB_ERR_MEMORY, RB_ERR_MISSING. */
RB_CHECKED enum rb_status rb_curves_create(struct rb_curves **curves, const struct rb_model *model,
                                           const struct rb_camera_def *camera,
                                           struct rb_error *err);
void rb_curves_destroy(struct rb_curves *curves); /* NULL is fine */

/* Every frame, in order of time. */
void rb_curves_add(struct rb_curves *curves, const struct rb_frame *frame);
/* Draws them all, up to the last frame that was added. */
void rb_curves_draw(struct rb_curves *curves, struct rb_pixmap *picture);

#endif
