/* SPDX-License-Identifier: MIT */
/*
 * Surfaces of bodies as triangles, for other programs: in object coordinates, counter-clockwise
 * seen from outside, with normals and colours (linear light). Round shapes are polyhedra of 24
 * sides with the normals of the round ones. Patterns of spheres, planes and rectangles are colours
 * of faces; pictures, and patterns of other shapes, are left out.
 *
 * The caller owns the surface. One thread.
 */
#ifndef RB_FLOW_TRIMESH_H
#define RB_FLOW_TRIMESH_H

#include <rbsim/model.h>

struct rb_trimesh_corner {
	float position[3]; /* m */
	float normal[3], colour[3];
};

struct rb_trimesh {
	struct rb_trimesh_corner *corners; /* owned, like what follows */
	uint32_t *indices;                 /* three each triangle */
	size_t corner_count, corner_room, index_count, index_room;
};

/* How much of an infinite plane is shown: a square, in the plane's object coordinates. */
struct rb_trimesh_patch {
	double x, y, half; /* m: its middle, half of its side */
};

/* Adds the surface of a body of the scene. `patch` is read of infinite planes only. RB_ERR_MEMORY.
 */
RB_CHECKED enum rb_status rb_trimesh_add(struct rb_trimesh *surface, const struct rb_scene *scene,
                                         const struct rb_body_def *body,
                                         const struct rb_trimesh_patch *patch,
                                         struct rb_error *err);
void rb_trimesh_release(struct rb_trimesh *surface); /* safe on a zeroed one */

/* A box round bodies: what infinite planes are shown below and around of. */
struct rb_trimesh_box {
	rb_vec3 low, high; /* m: corners; low > high: there is nothing in it yet */
};
struct rb_trimesh_box rb_trimesh_box_empty(void);
/* Extends it by a body, by index, whose origin is at `at`; by nothing for an infinite plane. */
void rb_trimesh_box_add(struct rb_trimesh_box *box, const struct rb_model *model, int index,
                        rb_vec3 at);
/* The same by all bodies that never move; with nothing in it it becomes a piece to be seen. */
void rb_trimesh_box_finish(struct rb_trimesh_box *box, const struct rb_model *model);
/* How much of an infinite plane is shown: what is below the box, and as much around it. */
struct rb_trimesh_patch rb_trimesh_box_patch(const struct rb_trimesh_box *box,
                                             const struct rb_model *model, int index);

#endif
