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

/*
 * Of a camera that has plots; `span_text` tells the time of its film. Model and camera are
 * borrowed. RB_ERR_MEMORY, RB_ERR_MISSING.
 */
RB_CHECKED enum rb_status rb_curves_create(struct rb_curves **curves, const struct rb_model *model,
                                           const struct rb_camera_def *camera,
                                           const char *span_text, struct rb_error *err);
void rb_curves_destroy(struct rb_curves *curves); /* NULL is fine */

/* Every frame, in order of time. */
void rb_curves_add(struct rb_curves *curves, const struct rb_frame *frame);
/*
 * Draws them all, up to the last frame that was added. Those without a place of their own stand one
 * above the other at the right, and leave this many px at the upper and the lower edge to others.
 */
void rb_curves_draw(struct rb_curves *curves, int upper_px, int lower_px,
                    struct rb_pixmap *picture);

#endif
