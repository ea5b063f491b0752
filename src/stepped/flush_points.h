/* SPDX-License-Identifier: MIT */
/*
 * Contact points on surfaces that several parts make up: tiles of a floor, parts of a union, facets
 * of a terrain. The nearest point of each part for itself may be on a border where another part
 * goes on: no point of the surface that both make up, and its normal is none of that surface.
 */
#ifndef RB_STEPPED_FLUSH_POINTS_H
#define RB_STEPPED_FLUSH_POINTS_H

#include "geom/manifold.h"
#include "world/world.h"

/* A contact point of a convex part, as of what it touches. */
struct rb_flush_point {
	const rb_placed *part; /* that it touches */
	rb_vec3 at;            /* m: on that part */
	rb_vec3 outward;       /* unit, from that part */
	double gap;            /* m */
};

/* The face of a part with this outward normal, or -1; that of a half space is 0. */
int rb_flush_face_along(const rb_placed *part, rb_vec3 normal);

/* Whether a part has faces, and what touches it along this outward normal is not on one. */
bool rb_flush_is_border(const rb_placed *part, rb_vec3 normal);

/*
 * Points of one convex part with parts that do not move relative to each other. Returns the index
 * of a point on a face, in whose plane k's part has a face, too, or -1. What is above that plane
 * touches k's part in it only, whichever direction k's own nearest point is in. Of several, that
 * whose normal is nearest to k's.
 */
int rb_flush_hidden_by(const struct rb_flush_point *point, int count, int k, double tolerance);

/* Whether a part has a face with this outward normal at a point, to the tolerance. */
bool rb_flush_goes_on(const rb_placed *part, rb_vec3 normal, rb_vec3 point, double tolerance);

/* The half space below the plane of a face. */
rb_placed rb_flush_plane(const rb_placed *part, int face, const rb_core *half_space);

/*
 * Whether a part touches with a corner or a rim: over a plane, no other place of it is lowest.
 * `feature`: as in the key of the point.
 */
bool rb_flush_is_corner(const rb_placed *part, uint32_t feature, rb_vec3 at, rb_vec3 direction);

/* The core of a finite plane, for scenes that keep none. */
struct rb_flush_rectangle {
	rb_vec3 vertices[4];
	rb_polytope_face faces[2];
	int loop[8];
	struct rb_polytope polytope;
	rb_core core;
	rb_placed placed;
};
void rb_flush_rectangle_set(struct rb_flush_rectangle *rectangle, const double size[2], rb_vec3 at,
                            rb_quat turn);

/*
 * Whether a point belongs to facet `j` of a terrain, a static, and not to a facet that continues
 * it.
 */
bool rb_flush_terrain_is_real(const struct rb_model *model, int terrain, int j,
                              const rb_manifold_point *at, rb_vec3 normal, const rb_placed *other);

#endif
