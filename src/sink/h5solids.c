/* SPDX-License-Identifier: MIT */
/*
 * Solids differ in the number of their vertices, faces and parts, so each quantity is one flat
 * dataset over all of them, with counts beside. One table says where each column comes from; one
 * loop writes them.
 */
#include "sink/h5solids.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "model/shape.h"

void rb_solids_kinds(char out[160])
{
	size_t used = 0;

	for (int k = 0; k < RB_SHAPE_KIND_COUNT && used < 160; k++)
		used += (size_t)snprintf(out + used, 160 - used, "%s%d %s", k > 0 ? ", " : "", k,
		                         rb_shape_name((enum rb_shape_kind)k));
}

/*
 * A column that is laid end to end from all solids, or all of their parts. Each takes `width`
 * numbers from `at`, an offset in what is listed, or what `from` points to.
 */
struct list {
	const char *path, *units;
	enum rb_h5_kind kind;
	int width;
	size_t (*count)(const struct rb_solid *solid);
	const void *(*from)(const struct rb_solid *solid);
	size_t at, stride; /* bytes */
};

static size_t vertex_count(const struct rb_solid *solid)
{
	return (size_t)solid->vertex_count;
}

static const void *vertices(const struct rb_solid *solid)
{
	return solid->vertices;
}

/* Corners of all faces; a solid of parts has no faces of its own. */
static size_t corner_count(const struct rb_solid *solid)
{
	return solid->face_count > 0 ? (size_t)solid->face_first[solid->face_count] : 0;
}

static const void *corners(const struct rb_solid *solid)
{
	return solid->loops;
}

/* Of a hull one more than it has faces, of a union none. */
static size_t bound_count(const struct rb_solid *solid)
{
	return solid->face_count > 0 ? (size_t)solid->face_count + 1 : 0;
}

static const void *bounds(const struct rb_solid *solid)
{
	return solid->face_first;
}

static size_t part_count(const struct rb_solid *solid)
{
	return (size_t)solid->part_count;
}

static const void *parts(const struct rb_solid *solid)
{
	return solid->parts;
}

static size_t one(const struct rb_solid *solid)
{
	(void)solid;
	return 1;
}

static const void *itself(const struct rb_solid *solid)
{
	return solid;
}

#define SOLID(member) one, itself, offsetof(struct rb_solid, member), sizeof(struct rb_solid)
#define PART(member) \
	part_count, parts, offsetof(struct rb_solid_part, member), sizeof(struct rb_solid_part)

static const struct list lists[] = {
	{"/rbsim/solids/vertex_count", NULL, RB_H5_I32, 1, SOLID(vertex_count)},
	{"/rbsim/solids/face_count", NULL, RB_H5_I32, 1, SOLID(face_count)},
	{"/rbsim/solids/part_count", NULL, RB_H5_I32, 1, SOLID(part_count)},
	{"/rbsim/solids/volume", "m^3", RB_H5_F64, 1, SOLID(volume)},
	{"/rbsim/solids/centroid", "m", RB_H5_F64, 3, SOLID(centroid)},
	{"/rbsim/solids/vertices", "m", RB_H5_F64, 3, vertex_count, vertices, 0, sizeof(rb_vec3)},
	{"/rbsim/solids/face_first", NULL, RB_H5_I32, 1, bound_count, bounds, 0, sizeof(int)},
	{"/rbsim/solids/loops", NULL, RB_H5_I32, 1, corner_count, corners, 0, sizeof(int)},
	{"/rbsim/solids/parts/kind", NULL, RB_H5_I32, 1, PART(shape.kind)},
	{"/rbsim/solids/parts/radius", "m", RB_H5_F64, 1, PART(shape.radius)},
	{"/rbsim/solids/parts/size", "m", RB_H5_F64, 3, PART(shape.size)},
	{"/rbsim/solids/parts/position", "m", RB_H5_F64, 3, PART(position)},
	{"/rbsim/solids/parts/orientation", NULL, RB_H5_F64, 4, PART(orientation)},
	{"/rbsim/solids/parts/share", NULL, RB_H5_F64, 1, PART(share)},
};

/* Records the failure, unless one stands already. */
static void no_memory(struct rb_h5 *h5, const char *path)
{
	if (!h5->status)
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY, "cannot record '%s': out of memory",
		                     path);
}

/* Writes one column. */
static void put_list(struct rb_h5 *h5, const struct rb_scene *scene, const struct list *list)
{
	const size_t bytes = (size_t)list->width * rb_h5_size(list->kind);
	size_t total = 0, used = 0;

	RB_ASSERT(list->width > 0);
	for (int i = 0; i < scene->solid_count; i++)
		total += list->count(&scene->solids[i]);
	unsigned char *const column = rb_memory_take(total + 1, bytes);
	if (!column) {
		no_memory(h5, list->path);
		return;
	}
	for (int i = 0; i < scene->solid_count; i++) {
		const unsigned char *from = list->from(&scene->solids[i]);
		const size_t count = list->count(&scene->solids[i]);

		for (size_t k = 0; k < count; k++)
			memcpy(column + bytes * used++, from + k * list->stride + list->at, bytes);
	}
	rb_h5_put(h5, list->path, list->kind,
	          (rb_h5_shape){list->width > 1 ? 2 : 1, {total, (hsize_t)list->width}}, column);
	rb_h5_units(h5, list->path, list->units);
	rb_memory_free(column);
}

/* Writes a list of 32-bit integers. */
static void put_numbers(struct rb_h5 *h5, const char *path, const int *number, size_t count)
{
	rb_h5_put(h5, path, RB_H5_I32, (rb_h5_shape){1, {count}}, number);
}

/* Writes which solid each body, and each part of a union, is made of; -1: it needs none. */
static void put_references(struct rb_h5 *h5, const struct rb_scene *scene)
{
	size_t bodies = (size_t)scene->body_count, all = 0, used = 0;

	for (int i = 0; i < scene->solid_count; i++)
		all += part_count(&scene->solids[i]);
	int *const number = rb_memory_take(bodies + all + 1, sizeof *number);
	if (!number) {
		no_memory(h5, "/rbsim/shapes/solid");
		return;
	}
	for (size_t i = 0; i < bodies; i++)
		number[used++] = rb_shape_solid(&scene->bodies[i].shape);
	for (int i = 0; i < scene->solid_count; i++)
		for (int k = 0; k < scene->solids[i].part_count; k++)
			number[used++] = rb_shape_solid(&scene->solids[i].parts[k].shape);
	RB_ASSERT(used <= bodies + all);
	put_numbers(h5, "/rbsim/shapes/solid", number, bodies);
	put_numbers(h5, "/rbsim/solids/parts/solid", number + bodies, all);
	rb_memory_free(number);
}

void rb_solids_write(struct rb_h5 *h5, const struct rb_scene *scene)
{
	if (scene->solid_count == 0)
		return;
	rb_h5_group(h5, "/rbsim/solids");
	for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++)
		put_list(h5, scene, &lists[i]);
	put_references(h5, scene);
}

bool rb_solids_tally(const struct rb_input *input, size_t count, int *kind,
                     int counts[RB_SHAPE_KIND_COUNT])
{
	static const char path[] = "/rbsim/shapes/kind";

	RB_ASSERT(kind && counts);
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		counts[k] = 0;
	/* a recording without bodies has no such column, and one of later versions other kinds */
	if (!rb_input_has(input, path))
		return true;
	if (!rb_input_numbers(input, path, RB_H5_I32, (rb_h5_shape){1, {count}}, kind))
		return false;
	for (size_t i = 0; i < count; i++)
		if (kind[i] >= 0 && kind[i] < RB_SHAPE_KIND_COUNT)
			counts[kind[i]]++;
	return true;
}
