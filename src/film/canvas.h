/* SPDX-License-Identifier: MIT */
/*
 * An off-screen OpenGL context with a picture to draw on: the only room that knows where contexts
 * come from.
 *
 * The picture is sRGB, what is drawn and blended is linear light; depth is 32-bit float and
 * reversed (1 near, 0 infinitely far). Row 0 of the window is the top row of the picture:
 * projections point downwards. Belongs to one thread; several canvases may take turns there, each
 * made current before it is used.
 */
#ifndef RB_FILM_CANVAS_H
#define RB_FILM_CANVAS_H

#include <stdbool.h>

#include "film/pixmap.h"

/* Every OpenGL function by its name, without a loader: the library exports them. */
#define GL_GLEXT_PROTOTYPES 1
#include <GL/gl.h>
#include <GL/glext.h>

struct rb_canvas;

enum { RB_CANVAS_SAMPLES_MAX = 16 };

/*
 * `samples`: wanted per pixel, fewer where the library can't do that many; 0 or 1: none.
 * RB_ERR_MISSING without a context of OpenGL 3.3 core or where drawing it would take minutes
 * (softpipe); RB_ERR_MEMORY.
 */
RB_CHECKED enum rb_status rb_canvas_create(struct rb_canvas **canvas, int width, int height,
                                           int samples, struct rb_error *err);
void rb_canvas_destroy(struct rb_canvas *canvas); /* NULL is fine */

/* To be called before any OpenGL call that is meant for this canvas. */
RB_CHECKED enum rb_status rb_canvas_enter(struct rb_canvas *canvas, struct rb_error *err);
/* The picture is what is drawn on from now on: whole viewport, conversion to sRGB. */
void rb_canvas_begin(struct rb_canvas *canvas);
/* Resolves samples and copies the picture to `pixmap`, which has the size of the canvas. */
RB_CHECKED enum rb_status rb_canvas_read(struct rb_canvas *canvas, struct rb_pixmap *pixmap,
                                         struct rb_error *err);

int rb_canvas_samples(const struct rb_canvas *canvas); /* 0: none */
/* Where in a pixel they lie, in [0, 1], x and y. */
const float (*rb_canvas_sample_positions(const struct rb_canvas *canvas))[2];
/* Clip space has depths from 0 to 1; where not, from -1 to 1, and precision far away is less. */
bool rb_canvas_depth_from_zero(const struct rb_canvas *canvas);
const char *rb_canvas_renderer(const struct rb_canvas *canvas);

/* Anything that OpenGL has complained of since the last call: RB_ERR_BUG, or RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_canvas_check(const char *doing, struct rb_error *err);

#endif
