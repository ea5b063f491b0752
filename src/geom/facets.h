/* SPDX-License-Identifier: MIT */
/*
 * Directions that can prove the gap of two polytopes: normals of faces, across two edges, from
 * vertex to vertex or edge. Pure functions.
 */
#ifndef RB_GEOM_FACETS_H
#define RB_GEOM_FACETS_H

#include "geom/axis_test.h"

/* Faces of polytopes, ends of cylinders. With a `guide`, only those that are nearly along it. */
void rb_facets_faces(rb_axis *axis, const rb_vec3 *guide);
/* Of faces and ends, those that prove no less than `least`, m: at most `most`. */
int rb_facets_ties(const rb_axis *axis, double least, rb_vec3 *normal, int max);
/* Edge against edge, of two polytopes. */
void rb_facets_edges(rb_axis *axis, const rb_slab *slab);
/* From a vertex to the nearest point of an edge or vertex, of two polytopes that are apart. */
void rb_facets_corners(rb_axis *axis, const rb_slab *slab);

/* A slab in a body's own axes: `low` is the height above which a vertex counts. */
typedef struct {
	rb_vec3 normal;
	double low;
} rb_slab_local;

static inline rb_slab_local rb_slab_of(const rb_placed *p, rb_vec3 outward, double depth)
{
	return (rb_slab_local){rb_mat3_apply_transposed(&p->turn, outward),
	                       rb_placed_height(p, outward) - depth};
}

static inline bool rb_slab_has(const rb_slab_local *slab, rb_vec3 vertex)
{
	return rb_vec3_dot(slab->normal, vertex) >= slab->low;
}

#endif
