/* SPDX-License-Identifier: MIT */
#include "sink/h5surfaces.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/trimesh.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "sink/h5polydata.h"

enum { BATCH_BYTES = 1 << 20, CHUNK_POINTS = 1 << 16 };

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot make surfaces: out of memory");
}

/* ---- meshes ---- */

static void release_mesh(struct rb_surface_mesh *mesh)
{
	rb_memory_free(mesh->points);
	rb_memory_free(mesh->corners);
	rb_memory_free(mesh->ids);
	rb_memory_free(mesh->colours);
	rb_memory_free(mesh->first);
	*mesh = (struct rb_surface_mesh){0};
}

void rb_surfaces_release(struct rb_surfaces *surfaces)
{
	release_mesh(&surfaces->moving);
	release_mesh(&surfaces->fixed);
	*surfaces = (struct rb_surfaces){0};
}

/* A table of points by their place, open addressing; -1: free. */
struct places {
	int32_t *slot;
	size_t size; /* a power of two, at least twice as many as points */
};

/* The point of the mesh from `first` on at this place, made if there is none. There is room. */
static int32_t point_at(struct rb_surface_mesh *mesh, const struct places *places,
                        const float position[3])
{
	float at[3];
	uint32_t bits[3];

	for (int k = 0; k < 3; k++)
		at[k] = position[k] + 0.0f; /* of two zeros one */
	memcpy(bits, at, sizeof bits);
	uint64_t key = bits[0] * UINT64_C(0x9e3779b97f4a7c15);
	key = (key ^ (key >> 29) ^ bits[1]) * UINT64_C(0xbf58476d1ce4e5b9);
	key = (key ^ (key >> 32) ^ bits[2]) * UINT64_C(0x94d049bb133111eb);
	for (size_t i = (key >> 31) & (places->size - 1);; i = (i + 1) & (places->size - 1)) {
		const int32_t there = places->slot[i];

		if (there >= 0 && memcmp(mesh->points + 3 * (size_t)there, at, sizeof at) == 0)
			return there;
		if (there >= 0)
			continue;
		memcpy(mesh->points + 3 * mesh->point_count, at, sizeof at);
		places->slot[i] = (int32_t)mesh->point_count++;
		return places->slot[i];
	}
}

/* Makes room for so many points and triangles more, and an empty table of places. */
static bool reserve(struct rb_surface_mesh *mesh, struct places *places,
                    const struct rb_trimesh *patch)
{
	const size_t triangles = mesh->triangle_count + patch->index_count / 3;

	for (places->size = 16; places->size < 2 * patch->corner_count;)
		places->size *= 2;
	places->slot = rb_memory_take(places->size, sizeof *places->slot);
	if (!places->slot || triangles > INT32_MAX / 3 ||
	    mesh->point_count + patch->corner_count > INT32_MAX)
		return false;
	memset(places->slot, 0xff, places->size * sizeof *places->slot);
	return rb_memory_reserve(&mesh->points, &mesh->point_room,
	                         3 * (mesh->point_count + patch->corner_count),
	                         sizeof *mesh->points) &&
	       rb_memory_reserve(&mesh->corners, &mesh->corner_room, 3 * triangles,
	                         sizeof *mesh->corners) &&
	       rb_memory_reserve(&mesh->ids, &mesh->id_room, triangles, sizeof *mesh->ids) &&
	       rb_memory_reserve(&mesh->colours, &mesh->colour_room, 3 * triangles,
	                         sizeof *mesh->colours);
}

/* From linear light to what screens take (IEC 61966-2-1). */
static uint8_t colour_of(float linear)
{
	const double l = fmin(fmax((double)linear, 0), 1);
	const double v = l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;

	return (uint8_t)lround(255 * v);
}

/* Adds the triangles of one body. A face has one colour. */
static bool add_triangles(struct rb_surface_mesh *mesh, const struct rb_trimesh *patch, int id)
{
	struct places places;
	const bool held = reserve(mesh, &places, patch);

	for (size_t k = 0; held && k + 2 < patch->index_count; k += 3) {
		const size_t t = mesh->triangle_count++;

		mesh->ids[t] = id;
		for (size_t c = 0; c < 3; c++) {
			const struct rb_trimesh_corner *const corner =
				&patch->corners[patch->indices[k + c]];
			mesh->corners[3 * t + c] = point_at(mesh, &places, corner->position);
		}
		const float *const colour = patch->corners[patch->indices[k]].colour;
		for (size_t c = 0; c < 3; c++)
			mesh->colours[3 * t + c] = colour_of(colour[c]);
	}
	rb_memory_free(places.slot);
	return held;
}

/* Adds the bodies from index `first` on that can be seen. `box`: round all that planes pass below.
 */
static enum rb_status make_mesh(struct rb_surface_mesh *mesh, const struct rb_model *model,
                                int first, int count, const struct rb_trimesh_box *box,
                                struct rb_error *err)
{
	const struct rb_scene *const scene = model->scene;
	struct rb_trimesh patch = {0};
	enum rb_status status = RB_OK;

	*mesh = (struct rb_surface_mesh){.body_first = first, .body_count = count};
	mesh->first = rb_memory_take((size_t)count + 1, sizeof *mesh->first);
	if (!mesh->first)
		return no_memory(err);
	for (int i = 0; i < count && !status; i++) {
		const int id = model->id_of[first + i];
		const struct rb_trimesh_patch shown = rb_trimesh_box_patch(box, model, first + i);

		patch.corner_count = patch.index_count = 0;
		if (scene->bodies[id].visible)
			status = rb_trimesh_add(&patch, scene, &scene->bodies[id], &shown, err);
		if (!status && !add_triangles(mesh, &patch, id))
			status = no_memory(err);
		mesh->first[i + 1] = mesh->point_count;
	}
	rb_trimesh_release(&patch);
	return status;
}

enum rb_status rb_surfaces_make(struct rb_surfaces *surfaces, const struct rb_model *model,
                                struct rb_error *err)
{
	struct rb_trimesh_box box = rb_trimesh_box_empty();

	*surfaces = (struct rb_surfaces){.model = model};
	rb_trimesh_box_finish(&box, model);
	const enum rb_status status = make_mesh(&surfaces->moving, model, 0, model->body_count,
	                                        &box, err);
	/* of planes too, for their number of points; where these are follows from the frames */
	return status ? status
	              : make_mesh(&surfaces->fixed, model, model->body_count, model->static_count,
	                          &box, err);
}

static uint64_t mesh_bytes(const struct rb_surface_mesh *mesh, uint64_t frames)
{
	return 12 * frames * (uint64_t)mesh->point_count + 39 * (uint64_t)mesh->triangle_count;
}

uint64_t rb_surfaces_bytes(const struct rb_surfaces *surfaces, uint64_t frames)
{
	return mesh_bytes(&surfaces->moving, frames) + mesh_bytes(&surfaces->fixed, 1) +
	       16 * frames;
}

/* ---- points ---- */

/* Moves points of a body from object to world coordinates. */
static void place_body(const struct rb_surface_mesh *mesh, int body, rb_vec3 position, rb_quat turn,
                       float *out)
{
	for (size_t k = mesh->first[body]; k < mesh->first[body + 1]; k++) {
		const float *const from = mesh->points + 3 * k;
		const rb_vec3 local = {(double)from[0], (double)from[1], (double)from[2]};
		const rb_vec3 at = rb_vec3_add(position, rb_quat_rotate(turn, local));

		out[3 * k] = (float)at.x;
		out[3 * k + 1] = (float)at.y;
		out[3 * k + 2] = (float)at.z;
	}
}

/* Rows of a column of bodies, as doubles. */
static void read_rows(struct rb_h5 *h5, hid_t dataset, hsize_t first, const hsize_t size[3],
                      double *out)
{
	const hid_t space = H5Dget_space(dataset), memory = H5Screate_simple(3, size, NULL);

	if (H5Sselect_hyperslab(space, H5S_SELECT_SET, (const hsize_t[]){first, 0, 0}, NULL, size,
	                        NULL) < 0 ||
	    H5Dread(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, out) < 0)
		rb_h5_fail(h5, "read", "/particles/bodies");
	rb_h5_done(memory);
	rb_h5_done(space);
}

static void write_rows(struct rb_h5 *h5, hid_t dataset, hsize_t first, hsize_t count,
                       const float *points)
{
	const hsize_t start[2] = {first, 0}, size[2] = {count, 3};
	const hid_t space = H5Dget_space(dataset), memory = H5Screate_simple(2, size, NULL);

	if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, size, NULL) < 0 ||
	    H5Dwrite(dataset, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, points) < 0)
		rb_h5_fail(h5, "write", "/VTKHDF/surfaces/Points");
	rb_h5_done(memory);
	rb_h5_done(space);
}

/* Makes the dataset of points; to be closed. */
static hid_t make_points(struct rb_h5 *h5, const char *path, hsize_t count, int compression)
{
	const hid_t space = H5Screate_simple(2, (const hsize_t[]){count, 3}, NULL);
	const hid_t links = rb_h5_link_properties();
	const hid_t properties = rb_h5_dataset_properties();

	H5Pset_fill_time(properties, H5D_FILL_TIME_NEVER);
	if (compression > 0) {
		const hsize_t chunk[2] = {count < CHUNK_POINTS ? count : CHUNK_POINTS, 3};

		H5Pset_chunk(properties, 2, chunk);
		H5Pset_shuffle(properties);
		H5Pset_deflate(properties, (unsigned)compression);
	}
	const hid_t dataset = H5Dcreate2(h5->file, path, H5T_IEEE_F32LE, space, links, properties,
	                                 H5P_DEFAULT);
	if (dataset < 0)
		rb_h5_fail(h5, "make", path);
	rb_h5_done(properties);
	rb_h5_done(links);
	rb_h5_done(space);
	return dataset;
}

/* What the points of some frames are made from, and the points. */
struct batch {
	hsize_t frames;                        /* of a batch at most */
	double *position, *orientation;        /* owned: [frames][bodies][3], [4] */
	float *points;                         /* owned: [frames][points][3] */
	hid_t from_position, from_orientation; /* -1: constant */
};

static void release_batch(struct batch *batch)
{
	rb_h5_done(batch->from_position);
	rb_h5_done(batch->from_orientation);
	rb_memory_free(batch->position);
	rb_memory_free(batch->orientation);
	rb_memory_free(batch->points);
}

/* Opens the columns and takes memory for a batch. */
static void begin_batch(struct rb_h5 *h5, struct batch *batch, const struct rb_surface_mesh *mesh,
                        const struct rb_surfaces_frames *frames)
{
	const size_t points = 12 * mesh->point_count;
	const size_t bodies = (size_t)mesh->body_count;
	const bool turns = frames->fields & RB_FIELD_ORIENTATION;

	*batch = (struct batch){.from_position = -1, .from_orientation = -1};
	batch->frames = points < BATCH_BYTES ? BATCH_BYTES / points : 1;
	batch->frames = batch->frames < frames->frames ? batch->frames : frames->frames;
	const size_t rows = (size_t)batch->frames;
	batch->position = rb_memory_take(3 * bodies * rows, sizeof *batch->position);
	batch->orientation = turns ? rb_memory_take(4 * bodies * rows, sizeof *batch->orientation)
	                           : NULL;
	batch->points = rb_memory_take(rows * points, 1);
	if (!batch->position || !batch->points || (turns && !batch->orientation)) {
		h5->status = no_memory(&h5->error);
		return;
	}
	batch->from_position = H5Dopen2(h5->file, "/particles/bodies/position/value", H5P_DEFAULT);
	if (turns)
		batch->from_orientation = H5Dopen2(h5->file, "/particles/bodies/orientation/value",
		                                   H5P_DEFAULT);
	if (batch->from_position < 0 || (turns && batch->from_orientation < 0))
		rb_h5_fail(h5, "read", "/particles/bodies");
}

/* Writes the points of all frames, and extends the box by where bodies are. */
static void write_points(struct rb_h5 *h5, const struct rb_surfaces *surfaces,
                         const struct rb_surfaces_frames *frames, hid_t points,
                         struct rb_trimesh_box *box)
{
	const struct rb_surface_mesh *const mesh = &surfaces->moving;
	const struct rb_model *const model = surfaces->model;
	const hsize_t bodies = (hsize_t)mesh->body_count;
	struct batch batch;

	begin_batch(h5, &batch, mesh, frames);
	for (hsize_t first = 0; first < frames->frames && !h5->status; first += batch.frames) {
		const hsize_t left = frames->frames - first;
		const hsize_t count = left < batch.frames ? left : batch.frames;

		read_rows(h5, batch.from_position, first, (const hsize_t[]){count, bodies, 3},
		          batch.position);
		if (batch.orientation)
			read_rows(h5, batch.from_orientation, first,
			          (const hsize_t[]){count, bodies, 4}, batch.orientation);
		for (hsize_t k = 0; k < count * bodies; k++) {
			const int i = (int)(k % bodies);
			const rb_vec3 at = rb_vec3_from(batch.position + 3 * k);
			const rb_quat turn = batch.orientation
			                             ? rb_quat_from(batch.orientation + 4 * k)
			                             : model->orientation[i];

			rb_trimesh_box_add(box, model, i, at);
			place_body(mesh, i, at, turn,
			           batch.points + 3 * mesh->point_count * (size_t)(k / bodies));
		}
		if (!h5->status)
			write_rows(h5, points, first * mesh->point_count, count * mesh->point_count,
			           batch.points);
	}
	release_batch(&batch);
}

/* ---- the parts ---- */

/* What stands there once: triangles, whose they are, their colours. */
static void put_triangles(struct rb_h5 *h5, const struct rb_polydata *data,
                          const struct rb_surface_mesh *mesh)
{
	const hsize_t triangles = mesh->triangle_count;

	rb_polydata_count(h5, data, mesh->point_count, triangles, 3 * triangles);
	rb_polydata_put(h5, data, "Polygons/Connectivity", RB_H5_I64,
	                (rb_h5_shape){1, {3 * triangles}}, mesh->corners);
	rb_polydata_ramp(h5, data, "Polygons/Offsets", triangles + 1, 3);
	rb_polydata_put(h5, data, "CellData/id", RB_H5_I32, (rb_h5_shape){1, {triangles}},
	                mesh->ids);
	rb_polydata_put(h5, data, "CellData/color", RB_H5_U8, (rb_h5_shape){2, {triangles, 3}},
	                mesh->colours);
	rb_polydata_fixed(h5, data, "CellData", "id");
	rb_polydata_fixed(h5, data, "CellData", "color");
}

/* The surfaces of what moves; extends the box by where it is. */
static void write_moving(struct rb_h5 *h5, struct rb_surfaces *surfaces,
                         const struct rb_surfaces_frames *frames, int index,
                         struct rb_trimesh_box *box)
{
	const struct rb_surface_mesh *const mesh = &surfaces->moving;
	const int compression = surfaces->model->scene->record.compression;
	const struct rb_polydata data = {"/VTKHDF/surfaces", frames->time, "Polygons",
	                                 frames->frames};

	rb_polydata_begin(h5, &data, index, false);
	put_triangles(h5, &data, mesh);
	rb_polydata_ramp(h5, &data, "Steps/PointOffsets", frames->frames,
	                 (int64_t)mesh->point_count);
	if (h5->status)
		return;
	const hid_t points = make_points(h5, "/VTKHDF/surfaces/Points",
	                                 frames->frames * mesh->point_count, compression);
	if (!h5->status && !frames->pretend)
		write_points(h5, surfaces, frames, points, box);
	rb_h5_done(points);
}

/* The surfaces of what stays; those of planes as far as the box needs. */
static void write_fixed(struct rb_h5 *h5, struct rb_surfaces *surfaces,
                        const struct rb_surfaces_frames *frames, int index,
                        struct rb_trimesh_box *box)
{
	const struct rb_model *const model = surfaces->model;
	struct rb_surface_mesh *const mesh = &surfaces->fixed;
	const struct rb_polydata data = {"/VTKHDF/statics", frames->time, "Polygons",
	                                 frames->frames};

	if (h5->status)
		return;
	release_mesh(mesh);
	rb_trimesh_box_finish(box, model);
	h5->status = make_mesh(mesh, model, model->body_count, model->static_count, box,
	                       &h5->error);
	if (h5->status)
		return;
	for (int i = 0; i < mesh->body_count; i++)
		place_body(mesh, i, model->position[mesh->body_first + i],
		           model->orientation[mesh->body_first + i], mesh->points);
	rb_polydata_begin(h5, &data, index, false);
	put_triangles(h5, &data, mesh);
	rb_polydata_constant(h5, &data, "Steps/PointOffsets", (rb_h5_shape){1, {frames->frames}},
	                     0);
	rb_polydata_put(h5, &data, "Points", RB_H5_F32, (rb_h5_shape){2, {mesh->point_count, 3}},
	                mesh->points);
}

void rb_surfaces_write(struct rb_h5 *h5, struct rb_surfaces *surfaces,
                       const struct rb_surfaces_frames *frames, int index)
{
	struct rb_trimesh_box box = rb_trimesh_box_empty();

	if (surfaces->moving.triangle_count > 0)
		write_moving(h5, surfaces, frames, index++, &box);
	if (surfaces->fixed.triangle_count > 0)
		write_fixed(h5, surfaces, frames, index, &box);
}
