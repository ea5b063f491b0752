/* SPDX-License-Identifier: MIT */
/*
 * Triangles that lie beside each other: which are near a point, and which touches at their edges
 * are real. Pure but for its memory.
 *
 * Made once, then constant and read by any thread; vertices and corners are borrowed from whoever
 * made it. m, object coordinates.
 *
 * A sphere on the seam of two triangles touches both. What one of them says there is its own, as if
 * the other were not, so that a ball that comes from one sees an edge of the next ahead of it. Such
 * a touch is real only if nothing of the surface is nearer in its direction: across the edge, the
 * neighbour must fall away from it (its Voronoi region; what Bullet calls internal edges).
 */
#ifndef RB_GEOM_TRIANGLES_H
#define RB_GEOM_TRIANGLES_H

#include <stdbool.h>

#include <rbsim/error.h>
#include <rbsim/math.h>

/* A facet is a triangle. No path from the root is longer than this. */
enum { RB_TERRAIN_DEPTH_MAX = 40 };

struct rb_terrain_node {
	rb_aabb box;
	int first; /* of its two children, or ~facet */
};

struct rb_terrain {
	int facet_count, vertex_count;
	const rb_vec3 *vertices;      /* [vertex_count], borrowed */
	const int (*corners)[3];      /* [facet_count], borrowed */
	struct rb_terrain_node *node; /* [2 facet_count - 1], the root first */
	/* the corner that is across each edge, of the neighbour; -1: a border, or several meet */
	int (*across)[3];
	int *spoke_first, *spokes; /* vertices joined to vertex v: from spoke_first[v] on */
};

RB_CHECKED enum rb_status rb_terrain_create(struct rb_terrain **terrain, const rb_vec3 *vertices,
                                            int vertex_count, const int (*corners)[3],
                                            int facet_count, struct rb_error *err);
void rb_terrain_destroy(struct rb_terrain *terrain); /* NULL is fine */

/* Facets whose boxes come within `within` of a point; that may be reduced on the way. */
struct rb_terrain_walk {
	const struct rb_terrain *terrain;
	rb_vec3 at;
	double within;   /* m; nearer ones come first, by and large */
	double rounding; /* m: added to it */
	int depth;
	int stack[RB_TERRAIN_DEPTH_MAX];
};

void rb_terrain_walk_begin(struct rb_terrain_walk *walk, const struct rb_terrain *terrain,
                           rb_vec3 at, double within);
int rb_terrain_walk_next(struct rb_terrain_walk *walk); /* -1: no more */

/*
 * Is a touch of something outside with a facet, at a point of it, real? `outward`: unit, from the
 * facet towards what touches it. What is round there touches where the facet is outermost, and
 * nowhere else; a face, or the straight side of what is round about `axis` (unit; zero: a sphere;
 * NULL: it is not round), may touch anywhere if it is nearly parallel.
 */
bool rb_terrain_touch_is_real(const struct rb_terrain *terrain, int facet, rb_vec3 point,
                              rb_vec3 outward, const rb_vec3 *axis);

/*
 * Does the surface go on in the plane of a facet, to rounding, on all sides of a point of its
 * border? What lies flat on it has no corner of its touch there. False within the facet.
 */
bool rb_terrain_goes_on(const struct rb_terrain *terrain, int facet, rb_vec3 point);

/* m: from a point to the nearest of three corners' triangle. */
double rb_terrain_distance(const rb_vec3 *a, const rb_vec3 *b, const rb_vec3 *c, rb_vec3 point);

#endif
