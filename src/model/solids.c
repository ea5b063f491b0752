/* SPDX-License-Identifier: MIT */
/*
 * Hulls and unions enter a scene here. Points are identified by SHA-256: scenes often make the same
 * hull thousands of times in a loop, and Qhull runs once for each set of points.
 */
#include <rbsim/scene.h>

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "geom/hull.h"
#include "geom/mass.h"
#include "math/quat.h"
#include "model/shape.h"

/*
 * Index of the solid made of the same points, newest first since loops repeat the last one; -1:
 * none.
 */
static int same_points(const struct rb_scene *scene, const char sha256[65])
{
	for (int i = scene->solid_count; i-- > 0;)
		if (memcmp(scene->solids[i].sha256, sha256, sizeof scene->solids[i].sha256) == 0)
			return i;
	return -1;
}

enum rb_status rb_scene_add_hull(struct rb_scene *scene, const rb_vec3 *points, size_t count,
                                 int *solid, struct rb_error *err)
{
	struct rb_solid made = {0};
	struct rb_hull hull;

	*solid = -1;
	rb_hash_sha256(points, count * sizeof *points, made.sha256);
	if (count > 0)
		*solid = same_points(scene, made.sha256);
	if (*solid >= 0)
		return RB_OK;
	enum rb_status status = rb_hull_make(&hull, points, count, err);
	if (status != RB_OK)
		return status;
	made.vertices = hull.vertices;
	made.loops = hull.loops;
	made.face_first = hull.face_first;
	made.edges = (const int(*)[2])hull.edges;
	made.vertex_count = hull.vertex_count;
	made.face_count = hull.face_count;
	made.edge_count = hull.edge_count;
	rb_solid_measure(&made);
	if (!(made.volume > 0 && isfinite(made.volume) && made.half_width > 0))
		status = RB_FAIL(
			err, RB_ERR_SCENE,
			"the hull's volume comes out as %g m^3 (wanted one that a double holds)",
			made.volume);
	else
		status = rb_scene_add_solid(scene, &made, solid, err);
	rb_hull_release(&hull);
	return status;
}

/* True for a shape of a type that may be a part, whose solid exists. */
static bool is_part(const struct rb_scene *scene, const struct rb_solid_part *part)
{
	const enum rb_shape_kind kind = part->shape.kind;

	if (kind < 0 || kind >= RB_SHAPE_KIND_COUNT || !rb_shape_types[kind]->is_part)
		return false;
	return !rb_shape_reads(&part->shape, RB_SHAPE_READS_SOLID) ||
	       (part->shape.solid >= 0 && part->shape.solid < scene->solid_count);
}

/* "sphere, box or hull": the types that may be parts. */
static void name_parts(char out[160])
{
	int left = 0;
	size_t used = 0;

	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		left += rb_shape_types[k]->is_part;
	for (int k = 0; k < RB_SHAPE_KIND_COUNT && used < 160; k++)
		if (rb_shape_types[k]->is_part)
			used += (size_t)snprintf(out + used, 160 - used, "a %s%s",
			                         rb_shape_types[k]->name,
			                         --left == 0 ? ""
			                         : left == 1 ? " or "
			                                     : ", ");
}

enum rb_status rb_scene_add_union(struct rb_scene *scene, const struct rb_solid_part *parts,
                                  size_t count, int *solid, struct rb_error *err)
{
	struct rb_solid made = {.parts = parts, .part_count = (int)count};

	*solid = -1;
	if (count == 0 || count > RB_UNION_PARTS_MAX)
		return RB_FAIL(err, RB_ERR_SCENE, "a union of %zu shapes (wanted 1 to %d)", count,
		               RB_UNION_PARTS_MAX);
	for (size_t k = 0; k < count; k++) {
		if (!is_part(scene, &parts[k])) {
			char wanted[160] = "";

			name_parts(wanted);
			return RB_FAIL(err, RB_ERR_SCENE,
			               "shape %zu cannot be part of a union (wanted %s)", k + 1,
			               wanted);
		}
		if (!(parts[k].share > 0 && isfinite(parts[k].share)) ||
		    !rb_vec3_finite(parts[k].position) ||
		    !(fabs(rb_quat_length(parts[k].orientation) - 1) <= 1e-3))
			return RB_FAIL(
				err, RB_ERR_SCENE,
				"shape %zu must have a positive share, a finite position and "
				"an orientation of unit length",
				k + 1);
	}
	rb_shape_measure_union(&made, scene->solids);
	if (!(made.weight > 0 && isfinite(made.weight)))
		return RB_FAIL(err, RB_ERR_SCENE,
		               "its volume comes out as %g m^3 (wanted one that a double holds)",
		               made.weight);
	return rb_scene_add_solid(scene, &made, solid, err);
}
