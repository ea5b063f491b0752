/* SPDX-License-Identifier: MIT */
/*
 * The convex hull of points, by Qhull (Barber, Dobkin, Huhdanpaa 1996), with its coplanar facets as
 * one face each.
 *
 * A pure function of the points; what it makes is owned by the caller until rb_hull_release. Points
 * are brought to a cube by a linear map before Qhull sees them, so that needles and foils are no
 * harder than cubes, and "coplanar" is what the rounding of the coordinates cannot tell from it.
 * Corners keep their coordinates to the bit.
 */
#ifndef RB_GEOM_HULL_H
#define RB_GEOM_HULL_H

#include <rbsim/scene.h>

/* As in struct rb_solid, but owned. */
struct rb_hull {
	rb_vec3 *vertices;
	int *loops, *face_first;
	int (*edges)[2];
	int vertex_count, face_count, edge_count;
};

/* RB_ERR_SCENE where the points have no hull (see rb_scene_add_hull), RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_hull_make(struct rb_hull *hull, const rb_vec3 *points, size_t count,
                                       struct rb_error *err);

/* "Qhull 8.0.2 (2020.2.r 2020/08/31)", of the library that is linked or loaded. */
void rb_hull_library(char *out, size_t size);

/* Safe on a zeroed hull and on one already released. */
void rb_hull_release(struct rb_hull *hull);

#endif
