/* SPDX-License-Identifier: MIT */
/*
 * Equal shapes share one list of parts: a heap of ten thousand equal boxes has one polytope, which
 * stays in cache. Equality is found by hashing the numbers that the shape's type reads, sorting by
 * hash, and comparing within runs of equal hashes, in the order of ids, so that the table does not
 * depend on anything but the scene.
 */
#include "model/parts.h"

#include <string.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/sort.h"
#include "geom/distance.h"
#include "model/shape.h"

/*
 * Copy of a shape with zeros for what its type does not read, also in padding: comparable by bytes.
 */
static struct rb_shape plain(const struct rb_shape *shape)
{
	struct rb_shape key;

	memset(&key, 0, sizeof key);
	key.kind = shape->kind;
	key.solid = rb_shape_reads(shape, RB_SHAPE_READS_SOLID) ? shape->solid : 0;
	key.radius = rb_shape_reads(shape, RB_SHAPE_READS_RADIUS) ? shape->radius : 0;
	for (int m = 0; m < 3; m++)
		key.size[m] = rb_shape_reads(shape, (unsigned)RB_SHAPE_READS_SIZE_X << m)
		                      ? shape->size[m]
		                      : 0;
	return key;
}

/* True if two shapes have the same geometry. */
static bool is_same(const struct rb_shape *a, const struct rb_shape *b)
{
	const struct rb_shape x = plain(a), y = plain(b);

	return memcmp(&x, &y, sizeof x) == 0;
}

/* Parts of the shape: those of a union, else one. */
static int count_of(const struct rb_scene *scene, const struct rb_shape *shape)
{
	if (shape->kind == RB_SHAPE_TERRAIN)
		return scene->solids[shape->solid].face_count;
	return rb_shape_type(shape)->form == RB_FORM_UNION ? scene->solids[shape->solid].part_count
	                                                   : 1;
}

/*
 * A facet as a flat body of its own, about the middle of its box, so that sizes are its own
 * wherever in the terrain it lies.
 */
static enum rb_status make_facet(struct rb_body_part *part, const struct rb_solid *solid, int facet,
                                 struct rb_error *err)
{
	static const int counts[2] = {3, 3};
	static const int loop[6] = {0, 1, 2, 2, 1, 0};
	rb_vec3 corner[3], low, high;
	struct rb_polytope *polytope;

	for (int k = 0; k < 3; k++)
		corner[k] = solid->vertices[solid->loops[3 * facet + k]];
	low = high = corner[0];
	for (int k = 1; k < 3; k++) {
		low = (rb_vec3){fmin(low.x, corner[k].x), fmin(low.y, corner[k].y),
		                fmin(low.z, corner[k].z)};
		high = (rb_vec3){fmax(high.x, corner[k].x), fmax(high.y, corner[k].y),
		                 fmax(high.z, corner[k].z)};
	}
	part->kind = RB_SHAPE_TERRAIN;
	part->turn = rb_mat3_diagonal(1, 1, 1);
	part->at = rb_vec3_add_scaled(low, 0.5, rb_vec3_sub(high, low));
	part->is_placed = true;
	for (int k = 0; k < 3; k++)
		corner[k] = rb_vec3_sub(corner[k], part->at);
	const rb_polytope_def def = {3, 2, corner, counts, loop};
	const enum rb_status status = rb_polytope_create(&polytope, &def, err);
	if (status == RB_OK)
		part->core = rb_core_of_polytope(polytope, 0);
	return status;
}

/* Appends the facets of a terrain. */
static enum rb_status make_terrain(struct rb_parts_table *table, const struct rb_solid *solid,
                                   struct rb_body_parts *made, struct rb_error *err)
{
	struct rb_terrain **const terrain = &table->terrain[made - table->shape];
	enum rb_status status = rb_terrain_create(terrain, solid->vertices, solid->vertex_count,
	                                          (const int(*)[3])solid->loops, solid->face_count,
	                                          err);

	made->terrain = *terrain;
	for (int k = 0; !status && k < solid->face_count; k++) {
		status = make_facet(&table->parts[table->part_count], solid, k, err);
		table->part_count += status == RB_OK;
		made->count += status == RB_OK;
	}
	return status;
}

/* Appends a shape and its parts to the table. */
static enum rb_status make_shape(struct rb_parts_table *table, const struct rb_scene *scene,
                                 const struct rb_shape *shape, struct rb_error *err)
{
	struct rb_body_parts *made = &table->shape[table->shape_count++];

	made->part = table->parts + table->part_count;
	if (shape->kind == RB_SHAPE_TERRAIN)
		return make_terrain(table, &scene->solids[shape->solid], made, err);
	for (int k = 0; k < count_of(scene, shape); k++) {
		struct rb_body_part *part = &table->parts[table->part_count];
		const struct rb_shape *own = shape;

		part->turn = rb_mat3_diagonal(1, 1, 1);
		if (rb_shape_type(shape)->form == RB_FORM_UNION) {
			const struct rb_solid_part *from = &scene->solids[shape->solid].parts[k];

			own = &from->shape;
			part->at = from->position;
			part->turn = rb_quat_to_mat3(rb_quat_unit(from->orientation));
			part->is_placed = true;
		}
		part->kind = own->kind;
		const enum rb_status status = rb_shape_core(scene->solids, own, &part->core, err);
		if (status != RB_OK)
			return status;
		table->part_count++;
		made->count++;
	}
	return RB_OK;
}

/* first[id]: the lowest id with the same shape; false when memory is out. */
static bool find_firsts(const struct rb_scene *scene, int *first)
{
	const size_t count = (size_t)scene->body_count;
	struct rb_sort_item *items = rb_memory_take(2 * count, sizeof *items);

	if (!items)
		return false;
	for (size_t i = 0; i < count; i++) {
		const struct rb_shape key = plain(&scene->bodies[i].shape);

		items[i] = (struct rb_sort_item){rb_hash_bytes(&key, sizeof key, 0), i};
	}
	rb_sort_by_key(items, items + count, count);
	for (size_t i = 0; i < count; i++) {
		const int id = (int)items[i].value;

		first[id] = id;
		/*
		 * equal shapes have equal keys, adjacent after sorting; different shapes hardly
		 * ever
		 */
		for (size_t j = i; j-- > 0 && items[j].key == items[i].key;) {
			const int other = (int)items[j].value;

			if (!is_same(&scene->bodies[other].shape, &scene->bodies[id].shape))
				continue;
			first[id] = first[other];
			break;
		}
	}
	rb_memory_free(items);
	return true;
}

static bool needs_parts(const struct rb_scene *scene)
{
	for (int i = 0; i < scene->body_count; i++)
		if (rb_shape_has_parts(scene->bodies[i].shape.kind))
			return true;
	return false;
}

/* Allocates for the distinct shapes, which shape_of[id] == id marks. */
static bool allocate(struct rb_parts_table *table, const struct rb_scene *scene)
{
	size_t shapes = 0, parts = 0;

	for (int i = 0; i < scene->body_count; i++) {
		if (table->shape_of[i] != i)
			continue;
		shapes++;
		parts += (size_t)count_of(scene, &scene->bodies[i].shape);
	}
	table->shape = rb_memory_take(shapes, sizeof *table->shape);
	table->parts = rb_memory_take(parts, sizeof *table->parts);
	table->terrain = rb_memory_take(shapes, sizeof *table->terrain);
	return table->shape && table->parts && table->terrain;
}

enum rb_status rb_parts_table_create(struct rb_parts_table **table, const struct rb_scene *scene,
                                     struct rb_error *err)
{
	enum rb_status status = RB_OK;

	*table = NULL;
	if (!needs_parts(scene))
		return RB_OK;
	struct rb_parts_table *made = rb_memory_take(1, sizeof *made);
	if (made)
		made->shape_of = rb_memory_take((size_t)scene->body_count, sizeof *made->shape_of);
	if (!made || !made->shape_of || !find_firsts(scene, made->shape_of) ||
	    !allocate(made, scene))
		status = RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the shapes of %d bodies",
		                 scene->body_count);
	for (int i = 0; status == RB_OK && i < scene->body_count; i++) {
		const int first = made->shape_of[i];

		if (first != i) {
			made->shape_of[i] = made->shape_of[first];
			continue;
		}
		made->shape_of[i] = made->shape_count;
		status = make_shape(made, scene, &scene->bodies[i].shape, err);
	}
	if (status != RB_OK) {
		rb_parts_table_destroy(made);
		return status;
	}
	RB_ASSERT(made->shape_count > 0 && made->part_count >= made->shape_count);
	*table = made;
	return RB_OK;
}

void rb_parts_table_destroy(struct rb_parts_table *table)
{
	if (!table)
		return;
	/* the table owns the polytopes, cores only refer to them */
	for (int k = 0; k < table->part_count; k++)
		rb_polytope_destroy((struct rb_polytope *)(uintptr_t)table->parts[k].core.polytope);
	for (int k = 0; table->terrain && k < table->shape_count; k++)
		rb_terrain_destroy(table->terrain[k]);
	rb_memory_free(table->terrain);
	rb_memory_free(table->shape);
	rb_memory_free(table->shape_of);
	rb_memory_free(table->parts);
	rb_memory_free(table);
}

rb_placed rb_body_part_place(const struct rb_body_part *part, rb_vec3 origin, rb_quat orientation)
{
	rb_placed placed = {
		.core = &part->core, .at = origin, .turn = rb_quat_to_mat3(orientation)};

	if (part->kind == RB_SHAPE_PLANE) {
		/* the normal that the closed forms for spheres use, to the bit */
		const rb_vec3 n = rb_plane_normal(orientation);

		placed.turn.m[0][2] = n.x;
		placed.turn.m[1][2] = n.y;
		placed.turn.m[2][2] = n.z;
	}
	if (part->is_placed) {
		placed.at = rb_vec3_add(origin, rb_mat3_apply(&placed.turn, part->at));
		placed.turn = rb_mat3_multiply(&placed.turn, &part->turn);
	}
	return placed;
}

double rb_parts_gap_at_start(const struct rb_parts_table *table, const struct rb_scene *scene,
                             int a, int b)
{
	RB_ASSERT(a >= 0 && a < scene->body_count && b >= 0 && b < scene->body_count && a != b);

	const struct rb_body_parts *of_a = rb_parts_of(table, a), *of_b = rb_parts_of(table, b);
	const rb_quat turn_a = rb_quat_unit(scene->bodies[a].orientation);
	const rb_quat turn_b = rb_quat_unit(scene->bodies[b].orientation);
	const rb_vec3 origin = {0, 0, 0};
	/* relative to a: far from the world's origin no digits are lost */
	const rb_vec3 way = rb_vec3_sub(scene->bodies[b].position, scene->bodies[a].position);
	double least = (double)INFINITY;

	/* of two, which are not both static, only the second is asked for what is near */
	RB_ASSERT(!of_a->terrain || !of_b->terrain);
	if (of_a->terrain)
		return rb_parts_gap_at_start(table, scene, b, a);
	for (int i = 0; i < of_a->count; i++) {
		const rb_placed at_a = rb_body_part_place(&of_a->part[i], origin, turn_a);
		const double reach = at_a.core->kind == RB_CORE_HALF_SPACE
		                             ? (double)INFINITY
		                             : rb_convex_reach(at_a.core);
		struct rb_near_parts near;
		int j;

		rb_near_parts_begin(&near, of_b, way, turn_b, at_a.at, reach + fmax(least, 0));
		while ((j = rb_near_parts_next(&near)) >= 0) {
			const rb_placed at_b = rb_body_part_place(&of_b->part[j], way, turn_b);
			const rb_separation s = rb_separation_of(&at_a, &at_b);

			least = fmin(least, s.gap - at_a.core->radius - at_b.core->radius);
			rb_near_parts_limit(&near, reach + fmax(least, 0));
		}
	}
	return least;
}
