/* SPDX-License-Identifier: MIT */
/*
 * What bodies look like: colour, and what decorates it. Made once from a scene; no OpenGL. Any
 * thread may read it.
 */
#ifndef RB_FILM_APPEARANCE_H
#define RB_FILM_APPEARANCE_H

#include <stdbool.h>

#include <rbsim/model.h>

#include "film/pixmap.h"

/* Numbers as in PATTERN of the shaders. */
enum rb_pattern {
	RB_PATTERN_PLAIN,
	RB_PATTERN_CHECKER,
	RB_PATTERN_STRIPES,
	RB_PATTERN_BEACHBALL,
	RB_PATTERN_IMAGE,
	RB_PATTERN_COUNT
};

struct rb_look {
	float colour[3], other[3]; /* linear light; `other` where a plane's pattern wants two */
	float gloss;               /* exponent of the highlight, 0: matt */
	enum rb_pattern pattern;
	int image; /* of the pictures, -1: none */
	bool visible;
	bool plain; /* no texture is stated, not even none */
};

struct rb_looks {
	struct rb_look *of; /* [body_count + static_count] by index, then those of joints, owned */
	struct rb_pixmap *images; /* [image_count], owned: each picture once */
	const char **names;       /* [image_count], owned; the texts are the scene's */
	int image_count;
	double size_m; /* a typical body's diameter */
	double cell_m; /* side of a square of a plane's pattern: 1, 2 or 5 x 10^k */
};

/* RB_ERR_SCENE: a texture that is no picture, with the place in the scene and the body. */
RB_CHECKED enum rb_status rb_looks_make(struct rb_looks *looks, const struct rb_model *model,
                                        struct rb_error *err);
/*
 * Planes whose texture nobody has stated become checkered: what moves over them is seen to move.
 * Squares are large enough to be told apart in the pictures of this camera.
 */
void rb_looks_show_motion(struct rb_looks *looks, const struct rb_model *model,
                          const struct rb_camera_def *camera);
void rb_looks_release(struct rb_looks *looks); /* safe on a zeroed one */

/* From sRGB in [0, 1] to linear light (IEC 61966-2-1). */
double rb_look_linear(double srgb);

#endif
