/* SPDX-License-Identifier: MIT */
/*
 * Which colour a body has, for all that shows bodies. Any thread.
 */
#ifndef RB_MODEL_COLOUR_H
#define RB_MODEL_COLOUR_H

#include <rbsim/scene.h>

/* From sRGB in [0, 1] to linear light (IEC 61966-2-1). */
double rb_colour_linear(double srgb);

/* Linear light: 0.9 of the body's colour, else of its material's, else of a palette. */
void rb_colour_of(const struct rb_scene *scene, const struct rb_body_def *body, double linear[3]);

/* The texture of the body, else of its material; NULL: none. */
const char *rb_colour_texture(const struct rb_scene *scene, const struct rb_body_def *body);

#endif
