/* SPDX-License-Identifier: MIT */
#include "film/extents.h"

#include <math.h>

#include "math/quat.h"

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
	if (shape->kind == RB_SHAPE_UNION) {
		*count = scene->solids[shape->solid].part_count;
		return scene->solids[shape->solid].parts;
	}
	*own = (struct rb_solid_part){.shape = *shape, .orientation = {1, 0, 0, 0}, .share = 1};
	*count = 1;
	return own;
}

const struct rb_solid *rb_part_faces(const struct rb_scene *scene, const struct rb_shape *shape)
{
	if (shape->kind == RB_SHAPE_BOX)
		return &box;
	return shape->kind == RB_SHAPE_HULL ? &scene->solids[shape->solid] : NULL;
}

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
	const double r = shape->radius, half = 0.5 * shape->size[2];
	rb_vec3 high = {r, r, r};
	double reach = r;

	if (shape->kind == RB_SHAPE_HULL)
		return hull_size(&scene->solids[shape->solid]);
	if (shape->kind == RB_SHAPE_BOX) {
		high = (rb_vec3){0.5 * shape->size[0], 0.5 * shape->size[1], half};
		reach = rb_vec3_length(high);
	} else if (shape->kind == RB_SHAPE_CAPSULE) {
		high.z = reach = r + half;
	} else if (shape->kind == RB_SHAPE_CYLINDER) {
		high.z = half;
		reach = hypot(r, half);
	}
	return (struct rb_part_size){
		.low = rb_vec3_neg(high), .high = high, .middle = {0, 0, 0}, .reach = reach};
}

rb_vec3 rb_part_normal(const struct rb_solid *solid, int face)
{
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
 * How far beyond its sides, along each: the distance to the corner between them outside, to the
 * nearest inside.
 */
static double beyond(rb_vec3 d)
{
	const double most = fmax(d.x, fmax(d.y, d.z));

	if (!(most > 0))
		return most;
	return rb_vec3_length((rb_vec3){fmax(d.x, 0), fmax(d.y, 0), fmax(d.z, 0)});
}

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

static double part_distance(const struct rb_scene *scene, const struct rb_shape *shape, rb_vec3 p)
{
	const double half = 0.5 * shape->size[2];

	switch (shape->kind) {
	case RB_SHAPE_SPHERE:
		return rb_vec3_length(p) - shape->radius;
	case RB_SHAPE_BOX:
		return beyond((rb_vec3){fabs(p.x) - 0.5 * shape->size[0],
		                        fabs(p.y) - 0.5 * shape->size[1], fabs(p.z) - half});
	case RB_SHAPE_CAPSULE:
		p.z -= fmin(fmax(p.z, -half), half);
		return rb_vec3_length(p) - shape->radius;
	case RB_SHAPE_CYLINDER:
		return beyond((rb_vec3){hypot(p.x, p.y) - shape->radius, fabs(p.z) - half,
		                        -(double)INFINITY});
	case RB_SHAPE_HULL:
		return hull_distance(&scene->solids[shape->solid], p);
	default: /* has no volume */
		return (double)INFINITY;
	}
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
