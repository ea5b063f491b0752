/* SPDX-License-Identifier: MIT */
/*
 * The shader programs that draw bodies, each made when it is first asked for.
 *
 * One thread, its canvas current in every call. The programs go with the canvas.
 */
#ifndef RB_FILM_PROGRAMS_H
#define RB_FILM_PROGRAMS_H

#include "film/canvas.h"
#include "film/glsl.h"
#include "film/light.h"
#include "film/appearance.h"

enum {
	RB_BALL_SIZES = 3, /* of spheres in the picture */
	RB_DISC_SIZES = 4, /* in shadow maps */
	RB_IMAGE_UNIT = 8  /* of textures, behind the shadow maps */
};

/* How a sphere is drawn. */
struct rb_ball_kind {
	enum rb_pattern pattern;
	int size;   /* as rb_ball_size says */
	bool exact; /* it cuts something: see film/shaders */
	bool rim;   /* the second time, for its edge; then not exact */
};

struct rb_surface_program {
	GLuint name; /* 0: not made */
	GLint corner, normal, axis_u, axis_v, paint, other;
};

struct rb_programs {
	/* set by the owner; borrowed */
	const struct rb_lights *lights;
	const struct rb_canvas *canvas;
	bool soft; /* edges are mixed in afterwards */
	bool cut;  /* near and far are the camera's: spheres may be open */
	bool grid; /* planes are wire models */

	/* private */
	GLuint ball[RB_PATTERN_COUNT][RB_BALL_SIZES][2][2];
	struct rb_surface_program surface[RB_PATTERN_COUNT][2][2]; /* infinite? glossy? */
	GLuint solid[RB_PATTERN_COUNT];
	GLuint disc[RB_DISC_SIZES], flat, solid_shadow;
};

int rb_ball_size(double radius_px);
/* Of the polygon; of the ring, a strip with two points each, and two more at its end. */
int rb_ball_corners(int size);
int rb_ring_corners(int size);

RB_CHECKED enum rb_status rb_programs_ball(struct rb_programs *programs, struct rb_ball_kind kind,
                                           GLuint *program, struct rb_error *err);
RB_CHECKED enum rb_status rb_programs_surface(struct rb_programs *programs, enum rb_pattern pattern,
                                              bool infinite, bool glossy, struct rb_error *err);
RB_CHECKED enum rb_status rb_programs_solid(struct rb_programs *programs, enum rb_pattern pattern,
                                            GLuint *program, struct rb_error *err);

/* Polygons for discs of that radius in a shadow map. */
int rb_disc_size(double radius_texels);
int rb_disc_corners(int size);
/* All that draw into shadow maps. */
RB_CHECKED enum rb_status rb_programs_shadows(struct rb_programs *programs, struct rb_error *err);

#endif
