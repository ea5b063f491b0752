/* SPDX-License-Identifier: MIT */
/*
 * One glTF 2.0 file in binary form (Khronos: ISO/IEC 12113): a node for each visible body under a
 * node that turns z up into y up, a mesh for each shape and colour, and an animation that moves and
 * turns the bodies through the recorded frames, straight from one to the next. Springs are lines, a
 * coil along z of length 1 in a node that is moved, turned and stretched.
 *
 * The binary chunk: times, corners of all meshes (position, normal, colour of each), their indices,
 * then for each moving body and each spring its positions and its orientations at all times, and
 * the lengths of springs. What is moved is held in memory, because bodies stand one after the other
 * there and frames in the recording.
 */
#include "app/exported.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "app/json.h"
#include "base/error.h"
#include "base/memory.h"
#include "flow/joint_view.h"
#include "force/spring.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/colour.h"

/* Numbers of glTF. */
enum { FLOAT32 = 5126, UINT32 = 5125, VERTICES = 34962, INDICES = 34963, LINE_STRIP = 3 };
/* Views of the buffer. */
enum {
	VIEW_TIMES,
	VIEW_CORNERS,
	VIEW_INDICES,
	VIEW_POSITIONS,
	VIEW_TURNS,
	VIEW_LENGTHS,
	VIEW_COUNT
};
/* Accessors of a mesh. */
enum { OF_MESH = 4 };

struct mesh {
	int body;   /* index of the first body that has it; -1: it is that of springs */
	int spring; /* number of the first spring that has it */
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
	int node_count;   /* so far, with the root */
	int *springs;     /* owned: those that are seen, whose tracks are behind those of bodies */
	int *spring_mesh; /* owned: of each of these */
	int spring_count;
	int first_spring_node;

	size_t frame_count;
	float *times;     /* owned */
	float *positions; /* owned: [moving and springs][frames][3] */
	float *turns; /* owned: [moving and springs][frames][4], x, y, z, w; NULL: nothing turns */
	float *lengths; /* owned: [springs][frames][3]: 1, 1, length */
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
	rb_memory_free(glb->springs);
	rb_memory_free(glb->spring_mesh);
	rb_memory_free(glb->lengths);
}

static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot export: out of memory");
}

static const struct rb_body_def *body_of(const struct glb *glb, int index)
{
	return &glb->scene->bodies[glb->model->id_of[index]];
}

/* All springs of the scene. */
static int element_count(const struct glb *glb)
{
	return rb_scene_element_count(glb->scene, &rb_force_spring);
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

	glb->node_count = 1; /* the root */
	glb->meshes = rb_memory_take(room + (size_t)element_count(glb), sizeof *glb->meshes);
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
		glb->node_of[i] = glb->node_count++;
		if (i < glb->model->body_count)
			glb->moving[glb->moving_count++] = i;
	}
	return status;
}

/* ---- springs ---- */

/* The look of a spring: radius of its coil (0: a straight line) and linear colour. */
struct spring_look {
	double radius_m, colour[3];
};

static struct spring_look look_of(const struct glb *glb, int spring)
{
	const struct rb_spring_def *const def = rb_scene_spring(glb->scene, spring);
	struct spring_look look = {0, {0.08, 0.08, 0.09}};

	if (element_count(glb) <= RB_COILS_MAX)
		look.radius_m = rb_spring_radius(glb->model, spring, 2 * glb->model->size_mean_m);
	for (int c = 0; c < 3 && !isnan(def->color[0]); c++)
		look.colour[c] = rb_colour_linear(def->color[c]);
	return look;
}

/* Finds or makes the mesh of a spring; its number, or -1: no memory. */
static int spring_mesh(struct glb *glb, int spring, int first_mesh)
{
	const struct spring_look look = look_of(glb, spring);
	struct rb_trimesh *const to = &glb->surface;

	for (int k = first_mesh; k < glb->mesh_count; k++) {
		const struct spring_look other = look_of(glb, glb->meshes[k].spring);
		if (memcmp(&look, &other, sizeof look) == 0)
			return k;
	}
	const int points = look.radius_m > 0 ? RB_COIL_POINTS : 2;
	if (!rb_memory_reserve(&to->corners, &to->corner_room, to->corner_count + (size_t)points,
	                       sizeof *to->corners) ||
	    !rb_memory_reserve(&to->indices, &to->index_room, to->index_count + (size_t)points,
	                       sizeof *to->indices))
		return -1;
	glb->meshes[glb->mesh_count] = (struct mesh){.body = -1,
	                                             .spring = spring,
	                                             .corner_first = to->corner_count,
	                                             .corner_count = (size_t)points,
	                                             .index_first = to->index_count,
	                                             .index_count = (size_t)points};
	for (int k = 0; k < points; k++) {
		const rb_vec3 p = rb_coil_point(points > 2 || k == 0 ? k : RB_COIL_POINTS - 1);
		const rb_vec3 out = rb_vec3_unit((rb_vec3){p.x, p.y, 0}, (rb_vec3){1, 0, 0});

		to->corners[to->corner_count++] = (struct rb_trimesh_corner){
			.position = {(float)(look.radius_m * p.x), (float)(look.radius_m * p.y),
		                     (float)p.z},
			.normal = {(float)out.x, (float)out.y, (float)out.z},
			.colour = {(float)look.colour[0], (float)look.colour[1],
		                   (float)look.colour[2]}};
		to->indices[to->index_count++] = (uint32_t)k;
	}
	return glb->mesh_count++;
}

/* Makes meshes and nodes of springs that are seen; whether one is does not change. */
static enum rb_status take_springs(struct glb *glb, const struct rb_frame *frame,
                                   struct rb_error *err)
{
	const int count = element_count(glb), first_mesh = glb->mesh_count;
	rb_vec3 end[2];

	glb->springs = rb_memory_take((size_t)count + 1, sizeof *glb->springs);
	glb->spring_mesh = rb_memory_take((size_t)count + 1, sizeof *glb->spring_mesh);
	if (!glb->springs || !glb->spring_mesh)
		return no_memory(err);
	glb->first_spring_node = glb->node_count;
	for (int k = 0; k < count; k++) {
		if (!rb_spring_ends(glb->model, frame, k, end))
			continue;
		const int mesh = spring_mesh(glb, k, first_mesh);
		if (mesh < 0)
			return no_memory(err);
		glb->springs[glb->spring_count] = k;
		glb->spring_mesh[glb->spring_count++] = mesh;
		glb->node_count++;
	}
	return RB_OK;
}

/* The turn that brings z to a direction, from one that brings it near: it does not twist. */
static rb_quat turn_to(rb_quat before, rb_vec3 way)
{
	const rb_vec3 z = rb_quat_rotate(before, (rb_vec3){0, 0, 1});
	const rb_vec3 axis = rb_vec3_cross(z, way);
	const double sine = rb_vec3_length(axis), angle = atan2(sine, rb_vec3_dot(z, way));
	const rb_vec3 unit = rb_vec3_unit(axis, rb_vec3_across(z));

	return rb_quat_unit(rb_quat_turned(before, rb_vec3_scale(angle, unit)));
}

/* Where a spring is: its end on a, how it is turned, how long it is. */
struct spring_place {
	rb_vec3 from;
	rb_quat turn;
	double length;
};

static struct spring_place place_of(const struct glb *glb, const struct rb_frame *frame, int spring,
                                    rb_quat before)
{
	rb_vec3 end[2];

	(void)rb_spring_ends(glb->model, frame, spring, end);
	const rb_vec3 span = rb_vec3_sub(end[1], end[0]);
	const double length = rb_vec3_length(span);
	/* what has no length has no direction either, and no inverse */
	return (struct spring_place){
		end[0], length > 0 ? turn_to(before, rb_vec3_scale(1 / length, span)) : before,
		fmax(length, 1e-6 * glb->model->size_mean_m)};
}

/* ---- tracks ---- */

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
	for (int s = 0; s < glb->spring_count; s++) {
		const size_t at = (size_t)(glb->moving_count + s) * rows + k;
		const float *const before = k > 0 ? glb->turns + 4 * (at - 1) : NULL;
		const rb_quat last = before ? (rb_quat){(double)before[3], (double)before[0],
		                                        (double)before[1], (double)before[2]}
		                            : (rb_quat){1, 0, 0, 0};
		const struct spring_place place = place_of(glb, frame, glb->springs[s], last);
		const float position[3] = {(float)place.from.x, (float)place.from.y,
		                           (float)place.from.z};
		const float scale[3] = {1, 1, (float)place.length};

		memcpy(glb->positions + 3 * at, position, sizeof position);
		put_turn(glb->turns + 4 * at, place.turn, before);
		memcpy(glb->lengths + 3 * ((size_t)s * rows + k), scale, sizeof scale);
	}
}

/* Reads the frames; times must grow in single precision too. */
static enum rb_status take_frames(struct glb *glb, struct rb_error *err)
{
	const struct rb_exported *const exported = glb->exported;
	const size_t rows = (size_t)exported->reading->frame_count;
	struct rb_frame frame;
	enum rb_status status = exported->module->reader_frame(exported->reader, 0, &frame, err);

	if (!status)
		status = take_springs(glb, &frame, err);
	if (status)
		return status;
	const size_t cells = rows * (size_t)(glb->moving_count + glb->spring_count);

	glb->times = rb_memory_take(rows, sizeof *glb->times);
	glb->positions = rb_memory_take(cells + 1, 3 * sizeof *glb->positions);
	glb->lengths = rb_memory_take(rows * (size_t)glb->spring_count + 1,
	                              3 * sizeof *glb->lengths);
	if (exported->reading->fields & RB_FIELD_ORIENTATION || glb->spring_count > 0) {
		glb->turns = rb_memory_take(cells + 1, 4 * sizeof *glb->turns);
		if (!glb->turns)
			return no_memory(err);
	}
	if (!glb->times || !glb->positions || !glb->lengths)
		return no_memory(err);
	for (uint64_t row = 0; row < rows; row++) {
		status = exported->module->reader_frame(exported->reader, row, &frame, err);
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

/* Tracks of bodies and springs with positions and, where there are any, turns. */
static int track_count(const struct glb *glb)
{
	return glb->moving_count + glb->spring_count;
}

/* Times, then those of meshes, then those of moving bodies and of springs, lengths of these. */
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
	for (int m = 0; m < track_count(glb); m++) {
		const uint64_t at = (uint64_t)m * frames * sizeof(float);
		put_accessor(glb, json,
		             &(struct accessor){VIEW_POSITIONS, 3 * at, frames, FLOAT32, "VEC3",
		                                NULL, NULL});
		if (glb->turns)
			put_accessor(glb, json,
			             &(struct accessor){VIEW_TURNS, 4 * at, frames, FLOAT32, "VEC4",
			                                NULL, NULL});
	}
	for (int s = 0; s < glb->spring_count; s++)
		put_accessor(glb, json,
		             &(struct accessor){VIEW_LENGTHS,
		                                3 * (uint64_t)s * frames * sizeof(float), frames,
		                                FLOAT32, "VEC3", NULL, NULL});
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
		if (glb->meshes[k].body < 0)
			rb_json_count(json, "mode", LINE_STRIP);
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
	for (int s = 0; s < glb->spring_count; s++)
		rb_json_count(json, NULL, (uint64_t)(glb->first_spring_node + s));
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
	for (int s = 0; s < glb->spring_count; s++) {
		const struct spring_place place = place_of(glb, first, glb->springs[s],
		                                           (rb_quat){1, 0, 0, 0});
		const rb_vec3 x = place.from;
		const rb_quat q = place.turn;

		snprintf(label, sizeof label, "spring#%d", glb->springs[s]);
		rb_json_open(json, NULL, '{');
		rb_json_text(json, "name", label);
		rb_json_count(json, "mesh", (uint64_t)glb->spring_mesh[s]);
		rb_json_vector(json, "translation", (const double[]){x.x, x.y, x.z}, 3);
		rb_json_vector(json, "rotation", (const double[]){q.x, q.y, q.z, q.w}, 4);
		rb_json_vector(json, "scale", (const double[]){1, 1, place.length}, 3);
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
}

/* The node that the track of a body or a spring is of. */
static int node_of_track(const struct glb *glb, int track)
{
	return track < glb->moving_count ? glb->node_of[glb->moving[track]]
	                                 : glb->first_spring_node + track - glb->moving_count;
}

/* A sampler or a channel for each accessor of a track. */
static void put_tracks(const struct glb *glb, struct rb_json *json, bool channels)
{
	static const char *const paths[] = {"translation", "rotation"};
	const int each = glb->turns ? 2 : 1, poses = track_count(glb) * each;
	const uint64_t first = 1 + (uint64_t)OF_MESH * (uint64_t)glb->mesh_count;

	rb_json_open(json, channels ? "channels" : "samplers", '[');
	for (int k = 0; k < poses + glb->spring_count; k++) {
		const int track = k < poses ? k / each : glb->moving_count + k - poses;

		rb_json_open(json, NULL, '{');
		if (channels) {
			rb_json_count(json, "sampler", (uint64_t)k);
			rb_json_open(json, "target", '{');
			rb_json_count(json, "node", (uint64_t)node_of_track(glb, track));
			rb_json_text(json, "path", k < poses ? paths[k % each] : "scale");
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
	if (track_count(glb) > 0) {
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
	const void *const from[VIEW_COUNT] = {
		glb->times, glb->surface.corners, glb->surface.indices, NULL, NULL, NULL};
	const size_t rows = (size_t)glb->exported->reading->frame_count;

	for (int k = 0; k <= VIEW_INDICES; k++)
		if (glb->size[k] > 0)
			fwrite(from[k], 1, glb->size[k], file);
	/* tracks have room for all rows; frames may be fewer */
	for (int m = 0; m < track_count(glb); m++)
		fwrite(glb->positions + 3 * (size_t)m * rows, 3 * sizeof(float), glb->frame_count,
		       file);
	for (int m = 0; glb->turns && m < track_count(glb); m++)
		fwrite(glb->turns + 4 * (size_t)m * rows, 4 * sizeof(float), glb->frame_count,
		       file);
	for (int s = 0; s < glb->spring_count; s++)
		fwrite(glb->lengths + 3 * (size_t)s * rows, 3 * sizeof(float), glb->frame_count,
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
	const uint64_t column = glb->frame_count * sizeof(float);
	const uint64_t tracks = (uint64_t)track_count(glb) * column;
	glb->size[VIEW_TIMES] = glb->frame_count * sizeof(float);
	glb->size[VIEW_CORNERS] = glb->surface.corner_count * sizeof(struct rb_trimesh_corner);
	glb->size[VIEW_INDICES] = glb->surface.index_count * sizeof(uint32_t);
	glb->size[VIEW_POSITIONS] = 3 * tracks;
	glb->size[VIEW_TURNS] = glb->turns ? 4 * tracks : 0;
	glb->size[VIEW_LENGTHS] = 3 * (uint64_t)glb->spring_count * column;
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
