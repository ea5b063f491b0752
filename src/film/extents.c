/* SPDX-License-Identifier: MIT */
/*
 * One view of all shapes for drawing: a shape is a list of parts, a part has faces (boxes of unit
 * size, hulls) or is round. Boxes share one table of a cube with edge 2, scaled by the shader.
 */
#include "film/extents.h"

#include "geom/triangles.h"

#include <math.h>

#include "base/error.h"
#include "math/quat.h"
#include "model/shape.h"

static const rb_vec3 box_corners[8] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                       {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
static const int box_loops[24] = {0, 4, 6, 2, 1, 3, 7, 5, 0, 1, 5, 4,
                                  2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6};
static const int box_first[7] = {0, 4, 8, 12, 16, 20, 24};
static const int box_edges[12][2] = {{0, 1}, {0, 2}, {0, 4}, {1, 3}, {1, 5}, {2, 3},
                                     {2, 6}, {3, 7}, {4, 5}, {4, 6}, {5, 7}, {6, 7}};
static const struct rb_solid box = {
	.vertices = box_corners,
	.loops = box_loops,
	.face_first = box_first,
	.edges = box_edges,
	.vertex_count = 8,
	.face_count = 6,
	.edge_count = 12,
};

const struct rb_solid_part *rb_parts_of(const struct rb_scene *scene, const struct rb_shape *shape,
                                        struct rb_solid_part *own, int *count)
{
	if (rb_shape_type(shape)->form == RB_FORM_UNION) {
		*count = scene->solids[shape->solid].part_count;
		return scene->solids[shape->solid].parts;
	}
	*own = (struct rb_solid_part){.shape = *shape, .orientation = {1, 0, 0, 0}, .share = 1};
	*count = 1;
	return own;
}

const struct rb_solid *rb_part_faces(const struct rb_scene *scene, const struct rb_shape *shape)
{
	const enum rb_shape_form form = rb_shape_type(shape)->form;

	if (form == RB_FORM_BOX)
		return &box;
	return form == RB_FORM_POLYHEDRON ? &scene->solids[shape->solid] : NULL;
}

/* Box and reach of a hull about its centroid. */
static struct rb_part_size hull_size(const struct rb_solid *solid)
{
	struct rb_part_size size = {
		.low = solid->vertices[0], .high = solid->vertices[0], .middle = solid->centroid};

	for (int k = 0; k < solid->vertex_count; k++) {
		const rb_vec3 v = solid->vertices[k];
		size.low = (rb_vec3){fmin(size.low.x, v.x), fmin(size.low.y, v.y),
		                     fmin(size.low.z, v.z)};
		size.high = (rb_vec3){fmax(size.high.x, v.x), fmax(size.high.y, v.y),
		                      fmax(size.high.z, v.z)};
		size.reach = fmax(size.reach, rb_vec3_length(rb_vec3_sub(v, size.middle)));
	}
	return size;
}

struct rb_part_size rb_part_size(const struct rb_scene *scene, const struct rb_shape *shape)
{
	const struct rb_shape_type *const type = rb_shape_type(shape);

	if (type->form == RB_FORM_POLYHEDRON)
		return hull_size(&scene->solids[shape->solid]);
	const rb_vec3 high = type->half(shape);
	return (struct rb_part_size){.low = rb_vec3_neg(high),
	                             .high = high,
	                             .middle = {0, 0, 0},
	                             .reach = rb_shape_reach(scene->solids, shape)};
}

rb_vec3 rb_part_normal(const struct rb_solid *solid, int face)
{
	RB_ASSERT_COSTLY(face >= 0 && face < solid->face_count);

	const int *loop = solid->loops + solid->face_first[face];
	const int count = solid->face_first[face + 1] - solid->face_first[face];
	const rb_vec3 first = solid->vertices[loop[0]];
	rb_vec3 sum = {0, 0, 0};

	for (int k = 1; k + 1 < count; k++)
		sum = rb_vec3_add(sum,
		                  rb_vec3_cross(rb_vec3_sub(solid->vertices[loop[k]], first),
		                                rb_vec3_sub(solid->vertices[loop[k + 1]], first)));
	return rb_vec3_unit(sum,
	                    rb_vec3_unit(rb_vec3_sub(first, solid->centroid), (rb_vec3){0, 0, 1}));
}

/*
 * Lower bound of the distance of p to a hull, m: the largest height above a face plane; far away
 * the distance to its bounding sphere, which is cheaper.
 */
static double hull_distance(const struct rb_solid *solid, rb_vec3 p)
{
	const rb_vec3 from_centre = rb_vec3_sub(p, solid->centroid);
	double most = rb_vec3_length(p) - solid->reach;

	if (most > rb_vec3_length(from_centre) * 0.5)
		return most;
	for (int f = 0; f < solid->face_count; f++) {
		const rb_vec3 on = solid->vertices[solid->loops[solid->face_first[f]]];
		most = fmax(most, rb_vec3_dot(rb_part_normal(solid, f), rb_vec3_sub(p, on)));
	}
	return most;
}

/* m: from p to the nearest triangle of a terrain. */
static double terrain_distance(const struct rb_solid *solid, rb_vec3 p)
{
	double least = (double)INFINITY;

	for (int f = 0; f < solid->face_count; f++) {
		const int *const corner = solid->loops + 3 * (size_t)f;
		least = fmin(least, rb_terrain_distance(&solid->vertices[corner[0]],
		                                        &solid->vertices[corner[1]],
		                                        &solid->vertices[corner[2]], p));
	}
	return least;
}

/* Distance of p in the part's axes; INFINITY for parts without volume. */
static double part_distance(const struct rb_scene *scene, const struct rb_shape *shape, rb_vec3 p)
{
	const struct rb_shape_type *const type = rb_shape_type(shape);

	if (type->form == RB_FORM_SURFACE) /* has no volume */
		return (double)INFINITY;
	if (shape->kind == RB_SHAPE_TERRAIN)
		return terrain_distance(&scene->solids[shape->solid], p);
	return type->distance ? type->distance(shape, p)
	                      : hull_distance(&scene->solids[shape->solid], p);
}

double rb_parts_distance(const struct rb_scene *scene, const struct rb_shape *shape, rb_vec3 point)
{
	struct rb_solid_part own;
	int count;
	const struct rb_solid_part *parts = rb_parts_of(scene, shape, &own, &count);
	double least = (double)INFINITY;

	for (int k = 0; k < count; k++)
		least = fmin(least, part_distance(scene, &parts[k].shape,
		                                  rb_quat_rotate_back(
							  parts[k].orientation,
							  rb_vec3_sub(point, parts[k].position))));
	return least;
}
