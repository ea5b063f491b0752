/* SPDX-License-Identifier: MIT */
/*
 * What a body is made of: the parts of a union, or itself; how large these are, and how far away.
 * Pure functions, any thread; the scene is borrowed.
 */
#ifndef RB_FILM_EXTENTS_H
#define RB_FILM_EXTENTS_H

#include <rbsim/scene.h>

/* `own` is room for the only part of what is no union. */
const struct rb_solid_part *rb_parts_of(const struct rb_scene *scene, const struct rb_shape *shape,
                                        struct rb_solid_part *own, int *count);

/*
 * In the part's own coordinates: a box around it, its middle, and how far the part reaches from
 * there.
 */
struct rb_part_size {
	rb_vec3 low, high, middle; /* m */
	double reach;              /* m */
};
struct rb_part_size rb_part_size(const struct rb_scene *scene, const struct rb_shape *shape);

/*
 * From a point in object coordinates to the nearest part of a shape with a volume: negative inside,
 * and outside never more than it is, though of a hull it may be less. m.
 */
double rb_parts_distance(const struct rb_scene *scene, const struct rb_shape *shape, rb_vec3 point);

/*
 * Corners, faces and edges of a box or a hull, NULL of others; those of a box are in half lengths
 * of its edges.
 */
const struct rb_solid *rb_part_faces(const struct rb_scene *scene, const struct rb_shape *shape);
/* Outwards, unit. */
rb_vec3 rb_part_normal(const struct rb_solid *solid, int face);

#endif
