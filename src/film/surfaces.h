/* SPDX-License-Identifier: MIT */
/*
 * Planes as a view shows them: polygons in view coordinates, which may reach infinity, and how
 * textures lie on them. No OpenGL; plain values of one thread.
 */
#ifndef RB_FILM_SURFACES_H
#define RB_FILM_SURFACES_H

#include "film/appearance.h"
#include "film/view.h"

enum { RB_SURFACE_PARTS = 4, RB_SURFACE_CORNERS = 12 };

/* An infinite plane or a rectangle that may be drawn. */
struct rb_surface {
	int index;
	bool infinite;

	/* in this view */
	bool shown;
	bool backed;     /* infinite, and the eye is behind it */
	float normal[4]; /* towards the eye; the eye's distance */
	float axis_u[4], axis_v[4];
	/* Fans; w = 0: at infinity. A rectangle has one of four corners. */
	float corner[RB_SURFACE_PARTS][RB_SURFACE_CORNERS][4];
	int corner_count[RB_SURFACE_PARTS], part_count;
};

void rb_surface_see(struct rb_surface *surface, const struct rb_model *model,
                    const struct rb_looks *looks, const struct rb_frame *frame,
                    const struct rb_view *view);
/*
 * When all are seen: who looks into a room from behind a wall sees nothing of the other walls that
 * is not in the room. (From within, each wall hides what is behind it.) True: something may have
 * been cut off.
 */
bool rb_surfaces_cut(struct rb_surface *surfaces, int count);

#endif
