/* SPDX-License-Identifier: MIT */
/*
 * One glTF 2.0 file in binary form (Khronos: ISO/IEC 12113): a node for each visible body under a
 * node that turns z up into y up, a mesh for each shape and colour, and an animation that moves and
 * turns the bodies through the recorded frames, straight from one to the next.
 *
 * The binary chunk: times, corners of all meshes (position, normal, colour of each), their indices,
 * then for each moving body its positions and its orientations at all times. What is moved is held
 * in memory, because bodies stand one after the other there and frames in the recording.
 */
#include "app/exported.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "app/json.h"
#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/colour.h"

/* Numbers of glTF. */
enum { FLOAT32 = 5126, UINT32 = 5125, VERTICES = 34962, INDICES = 34963 };
/* Views of the buffer. */
enum { VIEW_TIMES, VIEW_CORNERS, VIEW_INDICES, VIEW_POSITIONS, VIEW_TURNS, VIEW_COUNT };
/* Accessors of a mesh, and of a body that moves. */
enum { OF_MESH = 4, OF_BODY = 2 };

struct mesh {
	int body; /* index of the first body that has it */
	size_t corner_first, corner_count, index_first, index_count;
};

struct glb {
	struct rb_exported *exported;
	const struct rb_model *model;
	const struct rb_scene *scene;
	int total;

	struct rb_trimesh surface;
	struct mesh *meshes; /* owned: [mesh_count], room for all bodies */
	int mesh_count;
	int *mesh_of; /* owned: by body index; -1: it is not visible */
	int *node_of; /* owned: number of its node */
	int *moving;  /* owned: visible bodies that move, by number of their track */
	int moving_count;

	size_t frame_count;
	float *times;     /* owned */
	float *positions; /* owned: [moving][frames][3] */
	float *turns;     /* owned: [moving][frames][4], x, y, z, w; NULL: nothing turns */
	uint64_t size[VIEW_COUNT];
};

static void release(struct glb *glb)
{
	rb_trimesh_release(&glb->surface);
	rb_memory_free(glb->meshes);
	rb_memory_free(glb->mesh_of);
	rb_memory_free(glb->node_of);
	rb_memory_free(glb->moving);
	rb_memory_free(glb->times);
	rb_memory_free(glb->positions);
	rb_memory_free(glb->turns);
}

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot export: out of memory");
}

static const struct rb_body_def *body_of(const struct glb *glb, int index)
{
	return &glb->scene->bodies[glb->model->id_of[index]];
}

/* Whether two bodies have the same surface. */
static bool same_look(const struct glb *glb, int a, int b)
{
	const struct rb_body_def *const x = body_of(glb, a), *const y = body_of(glb, b);
	const char *const texture[2] = {rb_colour_texture(glb->scene, x),
	                                rb_colour_texture(glb->scene, y)};
	double colour[2][3];

	if (x->shape.kind == RB_SHAPE_PLANE || x->shape.kind != y->shape.kind ||
	    x->shape.radius != y->shape.radius || x->shape.solid != y->shape.solid ||
	    memcmp(x->shape.size, y->shape.size, sizeof x->shape.size) != 0 ||
	    strcmp(texture[0] ? texture[0] : "", texture[1] ? texture[1] : "") != 0)
		return false;
	rb_colour_of(glb->scene, x, colour[0]);
	rb_colour_of(glb->scene, y, colour[1]);
	return memcmp(colour[0], colour[1], sizeof colour[0]) == 0;
}

/* Finds or makes the mesh of a body. */
static enum rb_status take_mesh(struct glb *glb, int index, struct rb_error *err)
{
	const struct rb_trimesh_patch patch = rb_exported_patch(glb->exported, index);

	for (int k = glb->mesh_count - 1; k >= 0; k--)
		if (same_look(glb, glb->meshes[k].body, index)) {
			glb->mesh_of[index] = k;
			return RB_OK;
		}
	struct mesh *const mesh = &glb->meshes[glb->mesh_count];
	*mesh = (struct mesh){.body = index,
	                      .corner_first = glb->surface.corner_count,
	                      .index_first = glb->surface.index_count};
	const enum rb_status status = rb_trimesh_add(&glb->surface, glb->scene, body_of(glb, index),
	                                             &patch, err);
	mesh->corner_count = glb->surface.corner_count - mesh->corner_first;
	mesh->index_count = glb->surface.index_count - mesh->index_first;
	for (size_t k = mesh->index_first; k < glb->surface.index_count; k++)
		glb->surface.indices[k] -= (uint32_t)mesh->corner_first;
	glb->mesh_of[index] = glb->mesh_count++;
	return status;
}

/* Makes all meshes, and counts nodes and tracks. */
static enum rb_status take_bodies(struct glb *glb, struct rb_error *err)
{
	const size_t room = (size_t)glb->total + 1;
	enum rb_status status = RB_OK;
	int node = 1; /* behind the root */

	glb->meshes = rb_memory_take(room, sizeof *glb->meshes);
	glb->mesh_of = rb_memory_take(room, sizeof *glb->mesh_of);
	glb->node_of = rb_memory_take(room, sizeof *glb->node_of);
	glb->moving = rb_memory_take(room, sizeof *glb->moving);
	if (!glb->meshes || !glb->mesh_of || !glb->node_of || !glb->moving)
		return no_memory(err);
	for (int i = 0; i < glb->total && !status; i++) {
		glb->mesh_of[i] = -1;
		if (!body_of(glb, i)->visible)
			continue;
		status = take_mesh(glb, i, err);
		glb->node_of[i] = node++;
		if (i < glb->model->body_count)
			glb->moving[glb->moving_count++] = i;
	}
	return status;
}

/* An orientation, of the two that mean the same the one nearer to that before. */
static void put_turn(float *to, rb_quat q, const float *before)
{
	const double dot = before ? q.x * (double)before[0] + q.y * (double)before[1] +
	                                    q.z * (double)before[2] + q.w * (double)before[3]
	                          : 1;
	const double sign = dot < 0 ? -1 : 1;

	to[0] = (float)(sign * q.x);
	to[1] = (float)(sign * q.y);
	to[2] = (float)(sign * q.z);
	to[3] = (float)(sign * q.w);
}

/* Copies a frame to the tracks, as the next one. */
static void take_frame(struct glb *glb, const struct rb_frame *frame, size_t rows)
{
	const size_t k = glb->frame_count++;

	glb->times[k] = (float)frame->time_s;
	for (int m = 0; m < glb->moving_count; m++) {
		const size_t at = (size_t)m * rows + k;
		const rb_vec3 x = rb_exported_position(glb->exported, frame, glb->moving[m]);
		const float position[3] = {(float)x.x, (float)x.y, (float)x.z};

		memcpy(glb->positions + 3 * at, position, sizeof position);
		if (glb->turns)
			put_turn(glb->turns + 4 * at,
			         rb_exported_orientation(glb->exported, frame, glb->moving[m]),
			         k > 0 ? glb->turns + 4 * (at - 1) : NULL);
	}
}

/* Reads the frames; times must grow in single precision too. */
static enum rb_status take_frames(struct glb *glb, struct rb_error *err)
{
	const struct rb_exported *const exported = glb->exported;
	const size_t rows = (size_t)exported->reading->frame_count;
	const size_t cells = rows * (size_t)glb->moving_count;
	struct rb_frame frame;

	glb->times = rb_memory_take(rows, sizeof *glb->times);
	glb->positions = rb_memory_take(cells + 1, 3 * sizeof *glb->positions);
	if (exported->reading->fields & RB_FIELD_ORIENTATION) {
		glb->turns = rb_memory_take(cells + 1, 4 * sizeof *glb->turns);
		if (!glb->turns)
			return no_memory(err);
	}
	if (!glb->times || !glb->positions)
		return no_memory(err);
	for (uint64_t row = 0; row < rows; row++) {
		const enum rb_status status = exported->module->reader_frame(exported->reader, row,
		                                                             &frame, err);
		if (status)
			return status;
		if (glb->frame_count == 0 || (float)frame.time_s > glb->times[glb->frame_count - 1])
			take_frame(glb, &frame, rows);
	}
	return RB_OK;
}

/* ---- JSON ---- */

static void put_views(const struct glb *glb, struct rb_json *json)
{
	uint64_t at = 0;

	rb_json_open(json, "bufferViews", '[');
	for (int k = 0; k < VIEW_COUNT; k++) {
		if (glb->size[k] == 0)
			continue;
		rb_json_open(json, NULL, '{');
		rb_json_count(json, "buffer", 0);
		rb_json_count(json, "byteOffset", at);
		rb_json_count(json, "byteLength", glb->size[k]);
		if (k == VIEW_CORNERS)
			rb_json_count(json, "byteStride", sizeof(struct rb_trimesh_corner));
		if (k == VIEW_CORNERS || k == VIEW_INDICES)
			rb_json_count(json, "target", k == VIEW_CORNERS ? VERTICES : INDICES);
		rb_json_close(json, '}');
		at += glb->size[k];
	}
	rb_json_close(json, ']');
	rb_json_open(json, "buffers", '[');
	rb_json_open(json, NULL, '{');
	rb_json_count(json, "byteLength", at);
	rb_json_close(json, '}');
	rb_json_close(json, ']');
}

/* Number of a view among those that are there. */
static uint64_t view_number(const struct glb *glb, int view)
{
	uint64_t number = 0;

	for (int k = 0; k < view; k++)
		number += glb->size[k] > 0;
	return number;
}

/* What an accessor reads. */
struct accessor {
	int view;
	uint64_t offset, count;
	int type; /* FLOAT32, UINT32 */
	const char *shape;
	const double *low, *high; /* [3], or one number of a scalar; NULL: not stated */
};

static void put_accessor(const struct glb *glb, struct rb_json *json, const struct accessor *a)
{
	const int width = strcmp(a->shape, "SCALAR") == 0 ? 1 : 3;

	rb_json_open(json, NULL, '{');
	rb_json_count(json, "bufferView", view_number(glb, a->view));
	rb_json_count(json, "byteOffset", a->offset);
	rb_json_count(json, "componentType", (uint64_t)a->type);
	rb_json_count(json, "count", a->count);
	rb_json_text(json, "type", a->shape);
	if (a->low) {
		rb_json_vector(json, "min", a->low, width);
		rb_json_vector(json, "max", a->high, width);
	}
	rb_json_close(json, '}');
}

static void put_mesh_accessors(const struct glb *glb, struct rb_json *json, const struct mesh *mesh)
{
	const uint64_t stride = sizeof(struct rb_trimesh_corner);
	double low[3] = {(double)INFINITY, (double)INFINITY, (double)INFINITY};
	double high[3] = {-(double)INFINITY, -(double)INFINITY, -(double)INFINITY};
	struct accessor a = {
		VIEW_CORNERS, mesh->corner_first * stride, mesh->corner_count, FLOAT32, "VEC3", low,
		high};

	for (size_t k = mesh->corner_first; k < mesh->corner_first + mesh->corner_count; k++)
		for (int i = 0; i < 3; i++) {
			low[i] = fmin(low[i], (double)glb->surface.corners[k].position[i]);
			high[i] = fmax(high[i], (double)glb->surface.corners[k].position[i]);
		}
	put_accessor(glb, json, &a);
	a.low = NULL;
	a.offset += 3 * sizeof(float);
	put_accessor(glb, json, &a);
	a.offset += 3 * sizeof(float);
	put_accessor(glb, json, &a);
	put_accessor(glb, json,
	             &(struct accessor){VIEW_INDICES, mesh->index_first * sizeof(uint32_t),
	                                mesh->index_count, UINT32, "SCALAR", NULL, NULL});
}

/* Times, then those of meshes, then those of moving bodies. */
static void put_accessors(const struct glb *glb, struct rb_json *json)
{
	const double first = (double)glb->times[0];
	const double last = (double)glb->times[glb->frame_count - 1];
	const uint64_t frames = glb->frame_count;

	rb_json_open(json, "accessors", '[');
	put_accessor(glb, json,
	             &(struct accessor){VIEW_TIMES, 0, frames, FLOAT32, "SCALAR", &first, &last});
	for (int k = 0; k < glb->mesh_count; k++)
		put_mesh_accessors(glb, json, &glb->meshes[k]);
	for (int m = 0; m < glb->moving_count; m++) {
		const uint64_t at = (uint64_t)m * frames * sizeof(float);
		put_accessor(glb, json,
		             &(struct accessor){VIEW_POSITIONS, 3 * at, frames, FLOAT32, "VEC3",
		                                NULL, NULL});
		if (glb->turns)
			put_accessor(glb, json,
			             &(struct accessor){VIEW_TURNS, 4 * at, frames, FLOAT32, "VEC4",
			                                NULL, NULL});
	}
	rb_json_close(json, ']');
}

static void put_meshes(const struct glb *glb, struct rb_json *json)
{
	rb_json_open(json, "meshes", '[');
	for (int k = 0; k < glb->mesh_count; k++) {
		const uint64_t first = 1 + (uint64_t)OF_MESH * (uint64_t)k;

		rb_json_open(json, NULL, '{');
		rb_json_open(json, "primitives", '[');
		rb_json_open(json, NULL, '{');
		rb_json_open(json, "attributes", '{');
		rb_json_count(json, "POSITION", first);
		rb_json_count(json, "NORMAL", first + 1);
		rb_json_count(json, "COLOR_0", first + 2);
		rb_json_close(json, '}');
		rb_json_count(json, "indices", first + 3);
		rb_json_count(json, "material", 0);
		rb_json_close(json, '}');
		rb_json_close(json, ']');
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
	rb_json_open(json, "materials", '[');
	rb_json_open(json, NULL, '{');
	rb_json_open(json, "pbrMetallicRoughness", '{');
	rb_json_number(json, "metallicFactor", 0);
	rb_json_number(json, "roughnessFactor", 0.6);
	rb_json_close(json, '}');
	rb_json_bool(json, "doubleSided", true); /* rectangles have two sides */
	rb_json_close(json, '}');
	rb_json_close(json, ']');
}

/* The nodes; bodies stand where they are in the first frame. */
static void put_nodes(const struct glb *glb, struct rb_json *json, const struct rb_frame *first)
{
	static const double up[4] = {-0.70710678118654757, 0, 0, 0.70710678118654757};
	char label[64];

	rb_json_open(json, "nodes", '[');
	rb_json_open(json, NULL, '{');
	rb_json_text(json, "name", "z is up");
	rb_json_vector(json, "rotation", up, 4);
	rb_json_open(json, "children", '[');
	for (int i = 0; i < glb->total; i++)
		if (glb->mesh_of[i] >= 0)
			rb_json_count(json, NULL, (uint64_t)glb->node_of[i]);
	rb_json_close(json, ']');
	rb_json_close(json, '}');
	for (int i = 0; i < glb->total; i++) {
		if (glb->mesh_of[i] < 0)
			continue;
		const rb_vec3 x = rb_exported_position(glb->exported, first, i);
		const rb_quat q = rb_exported_orientation(glb->exported, first, i);
		float turn[4];

		put_turn(turn, q, NULL);
		rb_json_open(json, NULL, '{');
		rb_json_text(json, "name",
		             rb_scene_body_label(glb->scene, glb->model->id_of[i], label));
		rb_json_count(json, "mesh", (uint64_t)glb->mesh_of[i]);
		rb_json_vector(json, "translation", (const double[]){x.x, x.y, x.z}, 3);
		rb_json_vector(json, "rotation", (const double[]){q.x, q.y, q.z, q.w}, 4);
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
}

/* A sampler or a channel for each track. */
static void put_tracks(const struct glb *glb, struct rb_json *json, bool channels)
{
	const int tracks = glb->turns ? OF_BODY : 1;
	const uint64_t first = 1 + (uint64_t)OF_MESH * (uint64_t)glb->mesh_count;

	rb_json_open(json, channels ? "channels" : "samplers", '[');
	for (int k = 0; k < glb->moving_count * tracks; k++) {
		rb_json_open(json, NULL, '{');
		if (channels) {
			rb_json_count(json, "sampler", (uint64_t)k);
			rb_json_open(json, "target", '{');
			rb_json_count(json, "node",
			              (uint64_t)glb->node_of[glb->moving[k / tracks]]);
			rb_json_text(json, "path", k % tracks ? "rotation" : "translation");
			rb_json_close(json, '}');
		} else {
			rb_json_count(json, "input", 0);
			rb_json_count(json, "output", first + (uint64_t)k);
		}
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
}

static enum rb_status put_json(const struct glb *glb, FILE *file, struct rb_error *err)
{
	struct rb_json json = {.file = file};
	struct rb_frame first;
	const enum rb_status status = glb->exported->module->reader_frame(glb->exported->reader, 0,
	                                                                  &first, err);

	if (status)
		return status;
	rb_json_open(&json, NULL, '{');
	rb_json_open(&json, "asset", '{');
	rb_json_text(&json, "version", "2.0");
	rb_json_text(&json, "generator", "rbsim " RB_VERSION);
	rb_json_close(&json, '}');
	rb_json_count(&json, "scene", 0);
	rb_json_open(&json, "scenes", '[');
	rb_json_open(&json, NULL, '{');
	rb_json_open(&json, "nodes", '[');
	rb_json_count(&json, NULL, 0);
	rb_json_close(&json, ']');
	rb_json_close(&json, '}');
	rb_json_close(&json, ']');
	put_nodes(glb, &json, &first);
	put_meshes(glb, &json);
	put_accessors(glb, &json);
	put_views(glb, &json);
	if (glb->moving_count > 0) {
		rb_json_open(&json, "animations", '[');
		rb_json_open(&json, NULL, '{');
		put_tracks(glb, &json, false);
		put_tracks(glb, &json, true);
		rb_json_close(&json, '}');
		rb_json_close(&json, ']');
	}
	rb_json_close(&json, '}');
	return RB_OK;
}

/* ---- the file ---- */

static void put_u32(FILE *file, uint32_t value)
{
	const unsigned char bytes[4] = {(unsigned char)value, (unsigned char)(value >> 8),
	                                (unsigned char)(value >> 16), (unsigned char)(value >> 24)};

	fwrite(bytes, 1, sizeof bytes, file);
}

static void put_binary(const struct glb *glb, FILE *file)
{
	const void *const from[VIEW_COUNT] = {glb->times, glb->surface.corners,
	                                      glb->surface.indices, NULL, NULL};
	const size_t rows = (size_t)glb->exported->reading->frame_count;

	for (int k = 0; k <= VIEW_INDICES; k++)
		if (glb->size[k] > 0)
			fwrite(from[k], 1, glb->size[k], file);
	/* tracks have room for all rows; frames may be fewer */
	for (int m = 0; m < glb->moving_count; m++)
		fwrite(glb->positions + 3 * (size_t)m * rows, 3 * sizeof(float), glb->frame_count,
		       file);
	for (int m = 0; glb->turns && m < glb->moving_count; m++)
		fwrite(glb->turns + 4 * (size_t)m * rows, 4 * sizeof(float), glb->frame_count,
		       file);
}

/*
 * Header, JSON, binary. Lengths stand in front of what they are of: they are filled in at the end.
 */
static enum rb_status put_file(const struct glb *glb, const char *name, FILE *file, uint64_t binary,
                               struct rb_error *err)
{
	enum { HEADER = 12, CHUNK = 8 };

	fputs("glTF", file);
	put_u32(file, 2);
	put_u32(file, 0);
	put_u32(file, 0);
	fputs("JSON", file);
	const enum rb_status status = put_json(glb, file, err);
	if (status)
		return status;
	long end = ftell(file);
	for (; end % 4 != 0; end++)
		putc(' ', file);
	const uint64_t whole = (uint64_t)end + CHUNK + binary;
	if (end < 0 || whole > UINT32_MAX)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "'%s' does not fit into one glTF file, which has at most 4 GiB",
		               glb->exported->file);
	put_u32(file, (uint32_t)binary);
	fwrite("BIN", 1, 4, file);
	put_binary(glb, file);
	if (fseek(file, 8, SEEK_SET) != 0)
		return RB_FAIL(err, RB_ERR_IO, "cannot write '%s': %s", name, strerror(errno));
	put_u32(file, (uint32_t)whole);
	put_u32(file, (uint32_t)(end - HEADER - CHUNK));
	return RB_OK;
}

/* Everything that goes into the file. */
static enum rb_status gather(struct glb *glb, uint64_t *binary, struct rb_error *err)
{
	enum rb_status status = take_bodies(glb, err);

	if (!status)
		status = take_frames(glb, err);
	if (status)
		return status;
	const uint64_t tracks = (uint64_t)glb->moving_count * glb->frame_count * sizeof(float);
	glb->size[VIEW_TIMES] = glb->frame_count * sizeof(float);
	glb->size[VIEW_CORNERS] = glb->surface.corner_count * sizeof(struct rb_trimesh_corner);
	glb->size[VIEW_INDICES] = glb->surface.index_count * sizeof(uint32_t);
	glb->size[VIEW_POSITIONS] = 3 * tracks;
	glb->size[VIEW_TURNS] = glb->turns ? 4 * tracks : 0;
	*binary = 0;
	for (int k = 0; k < VIEW_COUNT; k++)
		*binary += glb->size[k];
	if (glb->mesh_count == 0)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' has no visible body", glb->exported->file);
	return RB_OK;
}

static enum rb_status write_glb(struct rb_exported *exported, const char *name,
                                struct rb_error *err)
{
	struct glb glb = {.exported = exported,
	                  .model = exported->loaded.model,
	                  .scene = &exported->loaded.scene,
	                  .total = exported->loaded.model->body_count +
	                           exported->loaded.model->static_count};
	struct rb_outfile out;
	uint64_t binary = 0;
	enum rb_status status = rb_exported_begin(exported, &out, name, err);

	if (status)
		return status;
	status = gather(&glb, &binary, err);
	if (!status)
		status = put_file(&glb, name, out.file, binary, err);
	release(&glb);
	if (!status)
		return rb_exported_publish(
			exported, &out, name,
			&(struct rb_export_content){glb.frame_count, "frame", "frames"}, err);
	rb_outfile_release(&out);
	return status;
}

_Static_assert(sizeof(struct rb_trimesh_corner) == 36, "as the stride of a view has it");

const struct rb_export_form rb_export_glb = {"glb", ".glb", write_glb, true};
