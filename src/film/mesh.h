/* SPDX-License-Identifier: MIT */
/*
 * Shapes as triangles, in units of the shape, so that all boxes share one mesh, and all round ones
 * of a fineness too.
 *
 * The caller owns the mesh; what is added gets a range in it. One thread, no OpenGL. Corners are
 * counter-clockwise seen from outside. With the numbers of rb_mesh_fit a vertex stands, from the
 * shape's middle, at
 *     scale * unit.xyz + (0, 0, shift unit.w),
 * and its texture at (count[axis[0]] tex[0], count[axis[1]] tex[1] + count[3] unit.w), counted from
 * the middle.
 */
#ifndef RB_FILM_MESH_H
#define RB_FILM_MESH_H

#include "film/extents.h"
#include "model/shape.h"

struct rb_mesh_vertex {
	float unit[4], normal[3], axis[2], tex[2];
};

struct rb_mesh {
	struct rb_mesh_vertex *vertices; /* owned, like what follows */
	uint32_t *indices;               /* three each triangle */
	size_t vertex_count, vertex_room, index_count, index_room;
};

struct rb_mesh_range {
	size_t first;
	int count; /* of indices */
};

void rb_mesh_release(struct rb_mesh *mesh); /* safe on a zeroed one */

/* Boxes and hulls: flat faces. RB_ERR_MEMORY, as all of these. */
RB_CHECKED enum rb_status rb_mesh_add_faces(struct rb_mesh *mesh, const struct rb_scene *scene,
                                            const struct rb_shape *shape,
                                            struct rb_mesh_range *range, struct rb_error *err);
/* Capsules and cylinders with so many sides, a multiple of four, of the area of their circles. */
RB_CHECKED enum rb_status rb_mesh_add_round(struct rb_mesh *mesh, enum rb_shape_form form,
                                            int sides, struct rb_mesh_range *range,
                                            struct rb_error *err);

struct rb_mesh_fit {
	float scale[3], shift;
	float count[4];
};

/*
 * `least`: a half-width that nothing falls below. `picture`: one covers a face, the side of a
 * cylinder, a capsule or the disc around a hull; else squares of a pattern that end at edges, an
 * even number of them from edge to edge.
 */
struct rb_mesh_fit rb_mesh_fit(const struct rb_shape *shape, const struct rb_part_size *size,
                               double least, bool picture);

#endif
