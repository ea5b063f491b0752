/* SPDX-License-Identifier: MIT */
/*
 * Lights of a camera, the sky, and where depth maps for shadows look. Pure mathematics, values, any
 * thread.
 */
#ifndef RB_FILM_LIGHT_H
#define RB_FILM_LIGHT_H

#include <stdbool.h>
#include <stddef.h>

#include "film/shaders.h"
#include "film/view.h"

struct rb_light {
	bool lamp;
	bool shadow;
	rb_vec3 place;    /* unit, towards it; or m, where it is */
	double colour[3]; /* linear light */
	double reach_m;   /* of a lamp: where it is as bright as it says */
	bool spot;        /* a lamp that lights a cone */
	rb_vec3 axis;     /* unit, towards the spot */
	double edge;      /* cosine of the angle where the cone ends */
	double rise;      /* 1 / (cosine where it is fully lit - `edge`) */
};

struct rb_lights {
	struct rb_light of[RB_CAMERA_LIGHTS_MAX];
	int count;
	rb_vec3 up; /* unit, world: against gravity */
	double ambient_up[3], ambient_down[3];
	double zenith[3], horizon[3], nadir[3];
	bool parallel; /* are the camera's lines of sight */
	bool plain;    /* `horizon` is all there is of the sky */
};

/* Those of the camera, else a sun with shadows and a weak light from the other side. */
void rb_lights_make(struct rb_lights *lights, const struct rb_model *model,
                    const struct rb_camera_def *camera);

/*
 * Definitions for the texts of shaders: colours, how numbers of the block come to fragments, and
 * the sum of the lights (`all`; else there are none).
 */
enum { RB_LIGHTS_DEFINES_SIZE = 6000 };
void rb_lights_define(const struct rb_lights *lights, bool all, char *defines, size_t room);

/* Fills the block but for its shadow maps. */
void rb_lights_tell(const struct rb_lights *lights, const struct rb_view *view, bool from_zero,
                    struct rb_shader_block *block);

/*
 * What throws shadows, in view coordinates: spheres (x, y, z, radius) with `stride` floats each,
 * corners of rectangles, and corners of boxes about solids that move and about others.
 */
struct rb_casters {
	const float *balls;
	int ball_count, stride;
	const float (*corners)[4];
	int corner_count;
	const float (*solids)[4], (*still)[4];
	int solid_corner_count, still_count;
};

enum { RB_SHADOW_SIDE = 2048 }; /* of the textures that hold maps, texels */

struct rb_shadow_fit {
	int side; /* texels, 0: nothing throws a shadow */
	float to_map
		[16]; /* view to clip coordinates of the map, columns first; depth from -w to w */
	float lookup[16]; /* view to coordinates and depth in a texture of `whole` texels */
	float source[4];  /* of the light in view coordinates; w = 1: a lamp */
};

/* `whole`: side of the texture, of which the map takes the corner at 0. */
void rb_shadow_fit(struct rb_shadow_fit *fit, const struct rb_light *light,
                   const struct rb_view *view, const struct rb_casters *casters, int whole);

/* What the block says of it. */
void rb_shadow_tell(const struct rb_shadow_fit *fit, const struct rb_light *light,
                    const struct rb_view *view, float rows[4][4]);

#endif
