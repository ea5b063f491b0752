/* SPDX-License-Identifier: MIT */
/*
 * The GLSL texts, parts of which film/glsl makes programs, and the block of numbers that all of
 * them read.
 *
 * Vertices are in view coordinates as in film/view; fragments in world axes, from the eye, where
 * lights and the sky stay what they are. Linear light, colours not premultiplied unless said.
 */
#ifndef RB_FILM_SHADERS_H
#define RB_FILM_SHADERS_H

#include <rbsim/scene.h>

/* The same as `Scene` in std140. */
struct rb_shader_block {
	float projection[16];
	float window[4];  /* x and y at -z = 1 of the upper left corner; their steps per pixel */
	float depth[4];   /* a, b as in rb_view_depth; near, far */
	float pixel[4];   /* its size at distance 1 */
	float axes[3][4]; /* world axes of view coordinates: right, up, back */
	/* Of a lamp, in world axes: where it is from the eye, and 1/d0^2. */
	float place[RB_CAMERA_LIGHTS_MAX][4];
	/*
	 * From world axes about the eye to the map's x, y and depth in [0, 1]. Of a lamp: rows of a
	 * matrix. Of a sun, whose axes never change: scale across, two offsets, scale of the depth;
	 * its offset.
	 */
	float shadow[RB_CAMERA_LIGHTS_MAX][4][4];
};

/*
 * The block and turned(); what fragments need of it is sent on by vertex shaders (CARRY, SEND of
 * film/light).
 */
extern const char rb_shader_scene[];
extern const char rb_shader_light[];   /* tone(), sky(), shine(), lit(): wants GLOSS, FINE */
extern const char rb_shader_pattern[]; /* coverage by patterns */

extern const char rb_shader_sphere_vertex[], rb_shader_sphere_fragment[];
extern const char rb_shader_plane_vertex[], rb_shader_plane_fragment[];
/* Of solids: how a corner of film/mesh is placed comes first in either vertex shader. */
extern const char rb_shader_solid[], rb_shader_solid_vertex[], rb_shader_solid_fragment[];
extern const char rb_shader_solid_shadow[];
extern const char rb_shader_sky_vertex[], rb_shader_sky_fragment[];
extern const char rb_shader_disc_vertex[], rb_shader_flat_vertex[], rb_shader_nothing[];
extern const char rb_shader_line_vertex[], rb_shader_line_fragment[];

#endif
