/* SPDX-License-Identifier: MIT */
/* Depth maps of the lights that throw shadows. One thread, its canvas current in every call. */
#ifndef RB_FILM_SHADOW_H
#define RB_FILM_SHADOW_H

#include "film/bodies.h"

struct rb_shadows {
	GLuint target, map[RB_CAMERA_LIGHTS_MAX]; /* map: 0 where the light has none */
	int whole;                                /* side of the maps, texels */
	int dirty[RB_CAMERA_LIGHTS_MAX];          /* so much of a map is not clear */
};

RB_CHECKED enum rb_status rb_shadows_make(struct rb_shadows *shadows,
                                          const struct rb_lights *lights, struct rb_error *err);
/*
 * Draws the maps for what `bodies` has gathered, binds them to the texture units from 0, and fills
 * the block's part.
 */
void rb_shadows_draw(struct rb_shadows *shadows, const struct rb_lights *lights,
                     const struct rb_view *view, struct rb_bodies *bodies,
                     struct rb_shader_block *block);

#endif
