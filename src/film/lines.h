/* SPDX-License-Identifier: MIT */
/*
 * Strokes over a picture: trails, arrows of velocities and contact forces, wire models of bodies,
 * dots for bodies that are too small, springs.
 * They are ribbons of constant width in pixels. One thread, its canvas current in every call.
 */
#ifndef RB_FILM_LINES_H
#define RB_FILM_LINES_H

#include "film/bodies.h"
#include "film/trails.h"

struct rb_lines;

/* Whether there is anything that would be drawn. */
bool rb_lines_needed(const struct rb_bodies_setup *setup);
/*
 * What is drawn follows from the camera: style, vectors, trails, dots for what is too small;
 * springs always.
 */
RB_CHECKED enum rb_status rb_lines_create(struct rb_lines **lines,
                                          const struct rb_bodies_setup *setup,
                                          struct rb_error *err);
void rb_lines_destroy(struct rb_lines *lines); /* NULL is fine */

/* `trails` may be NULL. Blending is on, depth is not written. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_lines_draw(struct rb_lines *lines, const struct rb_frame *frame,
                                        const struct rb_view *view, const struct rb_trails *trails,
                                        struct rb_error *err);

#endif
