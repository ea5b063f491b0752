/* SPDX-License-Identifier: MIT */
/*
 * Bodies on a canvas: spheres as ray-cast impostors, planes as polygons that may reach infinity;
 * other solids by film/solid_shapes.
 *
 * One thread, its canvas current in every call. What `see` has gathered holds until the next one.
 */
#ifndef RB_FILM_BODIES_H
#define RB_FILM_BODIES_H

#include "film/canvas.h"
#include "film/light.h"
#include "film/appearance.h"
#include "film/view.h"

/* What the vertex shader of spheres reads, in view coordinates. */
struct rb_ball {
	float centre[3], radius;
	float turn[4]; /* quaternion x, y, z, w: world to object coordinates */
	float colour[3], gloss;
};

struct rb_bodies;

struct rb_bodies_setup {
	const struct rb_model *model; /* borrowed, like what follows */
	const struct rb_looks *looks;
	const struct rb_camera_def *camera;
	const struct rb_lights *lights;
	const struct rb_canvas *canvas;
	bool soft; /* edges of spheres are mixed in afterwards: for canvases without samples */
};

RB_CHECKED enum rb_status rb_bodies_create(struct rb_bodies **bodies,
                                           const struct rb_bodies_setup *setup,
                                           struct rb_error *err);
void rb_bodies_destroy(struct rb_bodies *bodies); /* NULL is fine */

/* Gathers what a view of a frame shows. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_bodies_see(struct rb_bodies *bodies, const struct rb_frame *frame,
                                        const struct rb_view *view, struct rb_error *err);
/* What of it throws shadows; borrowed until the next `see`. */
struct rb_casters rb_bodies_casters(const struct rb_bodies *bodies);
/* Draws these into the map that is bound. */
void rb_bodies_throw(struct rb_bodies *bodies, const struct rb_shadow_fit *fit);
void rb_bodies_draw(struct rb_bodies *bodies);
/* The edges of spheres, when all else but lines is there. Blending is on, depth is not written. */
void rb_bodies_soften(struct rb_bodies *bodies);

#endif
