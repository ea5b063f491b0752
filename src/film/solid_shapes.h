/* SPDX-License-Identifier: MIT */
/*
 * Boxes, capsules, cylinders, hulls and such parts of unions on a canvas: triangles, many bodies in
 * one call.
 *
 * One thread, its canvas current in every call. What `see` has gathered holds until the next one.
 * Spheres in unions are drawn by film/bodies.
 */
#ifndef RB_FILM_SOLID_SHAPES_H
#define RB_FILM_SOLID_SHAPES_H

#include "film/isolated.h"
#include "film/programs.h"

struct rb_solids;

struct rb_solids_setup {
	const struct rb_model *model; /* borrowed, like what follows */
	const struct rb_looks *looks;
	struct rb_programs *programs;
	const GLuint *texture; /* by image */
};

RB_CHECKED enum rb_status rb_solids_create(struct rb_solids **solids,
                                           const struct rb_solids_setup *setup,
                                           struct rb_error *err);
void rb_solids_destroy(struct rb_solids *solids); /* NULL is fine */

/* How many of a scene are visible. */
int rb_solids_number(const struct rb_model *model, const struct rb_looks *looks);
int rb_solids_listed(const struct rb_solids *solids);

/* Gathers what a view of a frame shows. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_solids_see(struct rb_solids *solids, const struct rb_frame *frame,
                                        const struct rb_view *view, struct rb_error *err);
/* Spheres about them, in view coordinates: [rb_solids_listed]. */
const struct rb_apart_ball *rb_solids_around(const struct rb_solids *solids);
/* Adds corners of boxes about what throws shadows. */
void rb_solids_casters(const struct rb_solids *solids, struct rb_casters *casters);
/* Draws them into the map that is bound. */
void rb_solids_throw(const struct rb_solids *solids, const struct rb_shadow_fit *fit);
void rb_solids_draw(const struct rb_solids *solids);

#endif
