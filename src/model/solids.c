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
#include "base/memory.h"
#include "base/sort.h"
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

/* True for a triangle with an area that is no rounding of its sides. */
static bool has_area(const rb_vec3 *vertices, const int corner[3])
{
	const rb_vec3 a = vertices[corner[0]], b = vertices[corner[1]], c = vertices[corner[2]];
	const rb_vec3 ab = rb_vec3_sub(b, a), ac = rb_vec3_sub(c, a), bc = rb_vec3_sub(c, b);
	const double longest = fmax(rb_vec3_dot(ab, ab),
	                            fmax(rb_vec3_dot(ac, ac), rb_vec3_dot(bc, bc)));

	return rb_vec3_length(rb_vec3_cross(ab, ac)) > 1e-12 * longest;
}

/* Whether vertices and triangles can be what they are said to be. */
static enum rb_status check_terrain(const struct rb_terrain_def *def, struct rb_error *err)
{
	if (def->count == 0 || def->count > RB_TERRAIN_MAX)
		return RB_FAIL(err, RB_ERR_SCENE, "a terrain of %zu triangles (wanted 1 to %d)",
		               def->count, RB_TERRAIN_MAX);
	for (size_t k = 0; k < def->vertex_count; k++) {
		const rb_vec3 v = def->vertices[k];
		/* squares of coordinates must be finite, too */
		if (!rb_vec3_finite(v) || !(rb_vec3_max_abs(v) < 1e150))
			return RB_FAIL(err, RB_ERR_SCENE,
			               "its vertex %zu is not finite, or so large that its square "
			               "is not (%g, %g, %g)",
			               k + 1, v.x, v.y, v.z);
	}
	for (size_t k = 0; k < 3 * def->count; k++) {
		const int corner = def->corners[k / 3][k % 3];
		if (corner < 0 || (size_t)corner >= def->vertex_count)
			return RB_FAIL(err, RB_ERR_SCENE, "triangle %zu has no vertex %d of %zu",
			               k / 3 + 1, corner + 1, def->vertex_count);
	}
	return RB_OK;
}

/* Low and high corner of what the triangles take, and the reach from the origin. */
static void measure_terrain(struct rb_solid *made)
{
	rb_vec3 low = made->vertices[made->loops[0]], high = low;

	for (int k = 0; k < 3 * made->face_count; k++) {
		const rb_vec3 v = made->vertices[made->loops[k]];
		low = (rb_vec3){fmin(low.x, v.x), fmin(low.y, v.y), fmin(low.z, v.z)};
		high = (rb_vec3){fmax(high.x, v.x), fmax(high.y, v.y), fmax(high.z, v.z)};
		made->reach = fmax(made->reach, rb_vec3_length(v));
	}
	made->centroid = rb_vec3_scale(0.5, rb_vec3_add(low, high));
	made->half_width = made->reach;
}

/* Each edge once, sorted; -1: out of memory. */
static int terrain_edges(const struct rb_solid *made, int (*edges)[2])
{
	const size_t all = 3 * (size_t)made->face_count;
	struct rb_sort_item *const item = rb_memory_take(2 * all, sizeof *item);
	int count = 0;

	if (!item)
		return -1;
	for (size_t k = 0; k < all; k++) {
		const size_t next = k % 3 == 2 ? k - 2 : k + 1;
		const int v = made->loops[k], w = made->loops[next];
		item[k].key = (uint64_t)(v < w ? v : w) << 32 | (uint64_t)(v < w ? w : v);
	}
	rb_sort_by_key(item, item + all, all);
	for (size_t k = 0; k < all; k++) {
		if (k > 0 && item[k].key == item[k - 1].key)
			continue;
		edges[count][0] = (int)(item[k].key >> 32);
		edges[count++][1] = (int)(item[k].key & 0xffffffff);
	}
	rb_memory_free(item);
	return count;
}

enum rb_status rb_scene_add_terrain(struct rb_scene *scene, const struct rb_terrain_def *def,
                                    int *solid, struct rb_error *err)
{
	struct rb_solid made = {.vertices = def->vertices, .vertex_count = (int)def->vertex_count};
	enum rb_status status = check_terrain(def, err);

	*solid = -1;
	if (status)
		return status;
	int *const loops = rb_memory_take(3 * def->count, sizeof *loops);
	int *const first = rb_memory_take(def->count + 1, sizeof *first);
	int(*const edges)[2] = rb_memory_take(3 * def->count, sizeof *edges);
	if (!loops || !first || !edges)
		status = RB_FAIL(err, RB_ERR_MEMORY, "out of memory for a terrain of %zu triangles",
		                 def->count);
	for (size_t k = 0; !status && k < def->count; k++) {
		if (!has_area(def->vertices, def->corners[k]))
			continue;
		memcpy(loops + 3 * made.face_count, def->corners[k], sizeof def->corners[k]);
		first[made.face_count] = 3 * made.face_count;
		made.face_count++;
	}
	if (!status && made.face_count == 0)
		status = RB_FAIL(err, RB_ERR_SCENE, "none of its %zu triangles has an area",
		                 def->count);
	if (!status) {
		first[made.face_count] = 3 * made.face_count;
		made.loops = loops;
		made.face_first = first;
		made.edges = (const int(*)[2])edges;
		made.edge_count = terrain_edges(&made, edges);
		if (made.edge_count < 0)
			status = RB_FAIL(err, RB_ERR_MEMORY,
			                 "out of memory for the edges of a terrain");
	}
	if (!status) {
		measure_terrain(&made);
		status = rb_scene_add_solid(scene, &made, solid, err);
	}
	rb_memory_free(loops);
	rb_memory_free(first);
	rb_memory_free(edges);
	return status;
}
