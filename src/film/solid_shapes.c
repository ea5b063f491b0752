/* SPDX-License-Identifier: MIT */
/*
 * All solids but spheres, and joints: meshes shared by shape, drawn instanced in batches of one
 * mesh and program, sorted from near to far. What is out of view is drawn into shadow maps only.
 */
#include "film/solid_shapes.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "film/joint_shapes.h"
#include "film/mesh.h"
#include "math/quat.h"

/* Sides of round solids by radius in pixels: none is off by half a pixel. */
enum { FINENESSES = 4, OUT_OF_VIEW = FINENESSES, BUCKETS = FINENESSES + 1 };
static const int sides_of[FINENESSES] = {12, 24, 64, 192};
static const double most_px[FINENESSES] = {10, 50, 350, (double)INFINITY};
/* Fineness of bodies out of view, of which only the shadow is seen. */
static const int FINENESS_OUT = 1;
/* Smallest half width drawn, px: what flies away stays visible. */
static const double LEAST_PX = 0.6;
/* Thickness in texels below which a lit side may be shaded by the other side. */
static const double THIN_TEXELS = 4;

/* One part that is drawn; of a joint, size and shape change with every picture. */
struct item {
	int index; /* of its body; of a joint its number after all bodies */
	int piece; /* of a joint */
	int batch;
	struct rb_solid_part part;
	struct rb_part_size size;
	double half_width; /* m */
};

/* Items that share a mesh and a program. */
struct batch {
	struct rb_mesh_range mesh[FINENESSES];
	enum rb_pattern pattern;
	int image;
	double half_width; /* m, the least */
	int first[BUCKETS + 1];
};

/* As the vertex shader reads it, in view coordinates. */
struct instance {
	float centre[3], shift;
	float turn[4]; /* quaternion x, y, z, w: from object coordinates */
	float scale[3], gloss;
	float colour[4];
	float count[4];
};

enum { VERTEX_PLACES = 4, INSTANCE_PLACES = 5 };

struct rb_solids {
	struct rb_solids_setup setup;
	struct item *item; /* [count], owned, like what follows */
	int count, shown;  /* shown: in the picture that was seen last, without what is hidden */
	struct batch *batch;
	int batch_count;
	struct rb_sort_item *order, *scratch; /* [count] */
	struct instance *instance, *sorted;   /* [count] */
	struct rb_apart_ball *around;         /* [count] */
	float (*corner)
		[4]; /* [8 count]: of those that move, from the last on backwards of others */
	int moving_corners, still_corners;
	struct rb_mesh mesh; /* until it is OpenGL's */
	GLuint vertices, indices, instances, array;
};

/* ---- set-up ---- */

static bool is_drawn(const struct rb_solid_part *part)
{
	const enum rb_shape_form form = rb_shape_type(&part->shape)->form;

	return form != RB_FORM_SURFACE && form != RB_FORM_BALL;
}

static int bodies_of(const struct rb_model *model)
{
	return model->body_count + model->static_count;
}

/* Lists pieces of joints. */
static int list_pieces(const struct rb_model *model, const struct rb_looks *looks,
                       struct item *item)
{
	const struct rb_solid_part part = {
		.shape = {.kind = RB_SHAPE_CAPSULE, .solid = -1, .radius = 1, .size = {0, 0, 1}},
		.orientation = {1, 0, 0, 0}};
	int count = 0;

	for (int k = 0; k < model->scene->joint_count; k++) {
		const int index = bodies_of(model) + k;
		const int pieces = looks->of[index].visible ? rb_joint_piece_count(model, k) : 0;

		for (int p = 0; p < pieces; p++, count++) {
			if (!item)
				continue;
			item[count] = (struct item){.index = index, .piece = p, .part = part};
			item[count].part.shape.radius = rb_joint_radius(model, k);
		}
	}
	return count;
}

/* Lists the parts drawn here; with `item` NULL only counts them. */
static int list_items(const struct rb_model *model, const struct rb_looks *looks, struct item *item)
{
	int count = 0;

	for (int i = 0; i < bodies_of(model); i++) {
		struct rb_solid_part own;
		int part_count;
		if (!looks->of[i].visible || !rb_shape_has_parts(model->shape[i].kind))
			continue;
		const struct rb_solid_part *parts = rb_parts_of(model->scene, &model->shape[i],
		                                                &own, &part_count);
		for (int p = 0; p < part_count; p++) {
			if (is_drawn(&parts[p]) && item)
				item[count] = (struct item){.index = i, .part = parts[p]};
			count += is_drawn(&parts[p]);
		}
	}
	return count + list_pieces(model, looks, item ? item + count : NULL);
}

int rb_solids_number(const struct rb_model *model, const struct rb_looks *looks)
{
	return list_items(model, looks, NULL);
}

static double half_width(const struct rb_scene *scene, const struct item *item)
{
	const rb_vec3 high = item->size.high;

	if (rb_shape_type(&item->part.shape)->form == RB_FORM_POLYHEDRON)
		return scene->solids[item->part.shape.solid].half_width;
	return fmin(high.x, fmin(high.y, high.z));
}

/* Adds the mesh of a shape in all finenesses. */
static enum rb_status add_mesh(struct rb_solids *solids, const struct rb_shape *shape,
                               struct batch *batch, struct rb_error *err)
{
	const enum rb_shape_form form = rb_shape_type(shape)->form;
	enum rb_status status = RB_OK;

	if (rb_part_faces(solids->setup.model->scene, shape)) {
		status = rb_mesh_add_faces(&solids->mesh, solids->setup.model->scene, shape,
		                           &batch->mesh[0], err);
		for (int k = 1; k < FINENESSES; k++)
			batch->mesh[k] = batch->mesh[0];
		return status;
	}
	for (int k = 0; k < FINENESSES && status == RB_OK; k++)
		status = rb_mesh_add_round(&solids->mesh, form, sides_of[k], &batch->mesh[k], err);
	return status;
}

/* Key of the mesh: form and solid. */
static uint64_t mesh_of(const struct item *item)
{
	const struct rb_shape *shape = &item->part.shape;

	const enum rb_shape_form form = rb_shape_type(shape)->form;

	return (uint64_t)form << 32 | (form == RB_FORM_POLYHEDRON ? (uint32_t)shape->solid : 0);
}

static enum rb_status next_batch(struct rb_solids *solids, const struct item *item,
                                 const struct item *before, struct rb_error *err)
{
	const struct rb_look *look = &solids->setup.looks->of[item->index];
	struct batch *batch = &solids->batch[solids->batch_count++];

	*batch = (struct batch){
		.pattern = look->pattern, .image = look->image, .half_width = item->half_width};
	if (!before || mesh_of(before) != mesh_of(item))
		return add_mesh(solids, &item->part.shape, batch, err);
	memcpy(batch->mesh, batch[-1].mesh, sizeof batch->mesh);
	return RB_OK;
}

/* Sorts items by mesh, then pattern and picture, and makes a batch of each run. */
static enum rb_status make_batches(struct rb_solids *solids, struct rb_error *err)
{
	const struct rb_looks *looks = solids->setup.looks;
	const struct item *before = NULL;
	uint64_t look_before = 0;

	for (int pass = 0; pass < 2; pass++) {
		for (int k = 0; k < solids->count; k++) {
			struct rb_sort_item *row = &solids->order[k];
			if (pass == 0)
				row->value = (uint64_t)k;
			const struct item *item = &solids->item[row->value];
			const struct rb_look *look = &looks->of[item->index];
			row->key = pass == 1 ? mesh_of(item)
			                     : (uint64_t)look->pattern << 32 |
			                               (uint32_t)(look->image + 1);
		}
		rb_sort_by_key(solids->order, solids->scratch, (size_t)solids->count);
	}
	for (int k = 0; k < solids->count; k++) {
		struct item *item = &solids->item[solids->order[k].value];
		const struct rb_look *look = &looks->of[item->index];
		const uint64_t number = (uint64_t)look->pattern << 32 | (uint32_t)(look->image + 1);
		item->size = rb_part_size(solids->setup.model->scene, &item->part.shape);
		item->half_width = half_width(solids->setup.model->scene, item);
		if (!before || mesh_of(before) != mesh_of(item) || number != look_before) {
			const enum rb_status status = next_batch(solids, item, before, err);
			if (status != RB_OK)
				return status;
		}
		item->batch = solids->batch_count - 1;
		struct batch *batch = &solids->batch[item->batch];
		batch->half_width = fmin(batch->half_width, item->half_width);
		before = item;
		look_before = number;
	}
	return RB_OK;
}

/* Uploads all meshes. */
static void give_mesh(struct rb_solids *solids)
{
	static const struct {
		GLint size;
		size_t at;
	} places[VERTEX_PLACES] = {{4, offsetof(struct rb_mesh_vertex, unit)},
	                           {3, offsetof(struct rb_mesh_vertex, normal)},
	                           {2, offsetof(struct rb_mesh_vertex, axis)},
	                           {2, offsetof(struct rb_mesh_vertex, tex)}};
	const struct rb_mesh *mesh = &solids->mesh;

	glGenVertexArrays(1, &solids->array);
	glGenBuffers(1, &solids->vertices);
	glGenBuffers(1, &solids->indices);
	glGenBuffers(1, &solids->instances);
	glBindVertexArray(solids->array);
	glBindBuffer(GL_ARRAY_BUFFER, solids->vertices);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(mesh->vertex_count * sizeof *mesh->vertices),
	             mesh->vertices, GL_STATIC_DRAW);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, solids->indices);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER,
	             (GLsizeiptr)(mesh->index_count * sizeof *mesh->indices), mesh->indices,
	             GL_STATIC_DRAW);
	for (GLuint k = 0; k < VERTEX_PLACES; k++) {
		glEnableVertexAttribArray(k);
		glVertexAttribPointer(k, places[k].size, GL_FLOAT, GL_FALSE, sizeof *mesh->vertices,
		                      (const void *)places[k].at);
	}
	for (GLuint k = VERTEX_PLACES; k < VERTEX_PLACES + INSTANCE_PLACES; k++) {
		glEnableVertexAttribArray(k);
		glVertexAttribDivisor(k, 1);
	}
	rb_mesh_release(&solids->mesh);
}

static bool take_room(struct rb_solids *solids)
{
	const size_t n = (size_t)solids->count;

	solids->item = rb_memory_take(n, sizeof *solids->item);
	solids->batch = rb_memory_take(n, sizeof *solids->batch);
	solids->order = rb_memory_take(n, sizeof *solids->order);
	solids->scratch = rb_memory_take(n, sizeof *solids->scratch);
	solids->instance = rb_memory_take(n, sizeof *solids->instance);
	solids->sorted = rb_memory_take(n, sizeof *solids->sorted);
	solids->around = rb_memory_take(n, sizeof *solids->around);
	solids->corner = rb_memory_take(n, 8 * sizeof *solids->corner);
	return solids->item && solids->batch && solids->order && solids->scratch &&
	       solids->instance && solids->sorted && solids->around && solids->corner;
}

enum rb_status rb_solids_create(struct rb_solids **solids_out, const struct rb_solids_setup *setup,
                                struct rb_error *err)
{
	*solids_out = NULL;
	struct rb_solids *solids = rb_memory_take(1, sizeof *solids);
	if (solids) {
		solids->setup = *setup;
		solids->count = list_items(setup->model, setup->looks, NULL);
	}
	if (!solids || !take_room(solids)) {
		rb_solids_destroy(solids);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw bodies: out of memory");
	}
	list_items(setup->model, setup->looks, solids->item);
	enum rb_status status = make_batches(solids, err);
	for (int k = 0; k < solids->batch_count && status == RB_OK; k++) {
		GLuint made;
		status = rb_programs_solid(setup->programs, solids->batch[k].pattern, &made, err);
	}
	if (status == RB_OK && solids->count > 0) {
		give_mesh(solids);
		status = rb_canvas_check("prepare solids", err);
	}
	if (status != RB_OK) {
		rb_solids_destroy(solids);
		return status;
	}
	*solids_out = solids;
	return RB_OK;
}

void rb_solids_destroy(struct rb_solids *solids)
{
	if (!solids)
		return;
	/* Names of OpenGL go with the canvas. */
	rb_mesh_release(&solids->mesh);
	rb_memory_free(solids->item);
	rb_memory_free(solids->batch);
	rb_memory_free(solids->order);
	rb_memory_free(solids->scratch);
	rb_memory_free(solids->instance);
	rb_memory_free(solids->sorted);
	rb_memory_free(solids->around);
	rb_memory_free(solids->corner);
	rb_memory_free(solids);
}

int rb_solids_listed(const struct rb_solids *solids)
{
	return solids->count;
}

const struct rb_apart_ball *rb_solids_around(const struct rb_solids *solids)
{
	return solids->around;
}

/* ---- what a view shows ---- */

static void fill(struct instance *to, const struct item *item, const struct rb_look *look,
                 rb_vec3 centre, double least)
{
	const struct rb_mesh_fit fit = rb_mesh_fit(&item->part.shape, &item->size, least,
	                                           look->pattern == RB_PATTERN_IMAGE);

	to->centre[0] = (float)centre.x;
	to->centre[1] = (float)centre.y;
	to->centre[2] = (float)centre.z;
	to->shift = fit.shift;
	memcpy(to->scale, fit.scale, sizeof to->scale);
	to->gloss = look->gloss;
	memcpy(to->colour, look->colour, sizeof look->colour);
	to->colour[3] = 1;
	memcpy(to->count, fit.count, sizeof to->count);
}

/* Corners of the box around an item, for fitting shadow maps. */
static void surround(struct rb_solids *solids, const struct item *item, rb_vec3 centre,
                     const rb_mat3 *turn)
{
	const bool moves = item->index < solids->setup.model->body_count ||
	                   item->index >= bodies_of(solids->setup.model);
	float(*to)[4] = solids->corner + (moves ? solids->moving_corners
	                                        : 8 * solids->count - solids->still_corners - 8);

	for (int k = 0; k < 8; k++) {
		const rb_vec3 local = {k & 1 ? item->size.high.x : item->size.low.x,
		                       k & 2 ? item->size.high.y : item->size.low.y,
		                       k & 4 ? item->size.high.z : item->size.low.z};
		const rb_vec3 at = rb_vec3_add(
			centre, rb_mat3_apply(turn, rb_vec3_sub(local, item->size.middle)));
		to[k][0] = (float)at.x;
		to[k][1] = (float)at.y;
		to[k][2] = (float)at.z;
		to[k][3] = 1;
	}
	*(moves ? &solids->moving_corners : &solids->still_corners) += 8;
}

static int bucket_of(const struct item *item, const struct rb_view *view,
                     const struct rb_view_edges *edges, rb_vec3 centre, double least)
{
	const double distance = rb_vec3_length(centre);
	int fineness = 0;

	if (rb_view_misses(edges, centre,
	                   fmax(item->size.reach, least) + 2 * rb_view_pixel_at(view, distance)))
		return OUT_OF_VIEW;
	/* From where it is nearest: one may stand beside the end of a long cylinder. */
	const double nearest = fmax(distance - item->size.reach, view->near);
	while (item->part.shape.radius > most_px[fineness] * rb_view_pixel_at(view, nearest))
		fineness++;
	return fineness;
}

static uint32_t bits_of(double distance)
{
	const float value = (float)distance;
	uint32_t bits;

	memcpy(&bits, &value, sizeof bits);
	return bits;
}

/* A view of a frame, while its items are gathered. */
struct scan {
	const struct rb_frame *frame;
	const struct rb_view *view;
	struct rb_view_edges edges;
	rb_quat to_view;
	struct rb_joint_piece piece[RB_JOINT_PIECES_MAX]; /* of the joint that is being listed */
	bool shown;                                       /* it is to be seen */
};

/*
 * Where an item is, and of a joint how large; false: it is not to be seen. Pieces of a joint come
 * one after the other, from the first on.
 */
static bool place_item(struct rb_solids *solids, struct scan *scan, struct item *item,
                       rb_pose *pose)
{
	const struct rb_model *model = solids->setup.model;
	const int joint = item->index - bodies_of(model);

	if (joint < 0) {
		*pose = rb_view_part(rb_view_pose(model, scan->frame, model->id_of[item->index]),
		                     &item->part);
		return true;
	}
	if (item->piece == 0)
		scan->shown = rb_joint_pieces(model, scan->frame, joint, scan->piece);
	if (!scan->shown)
		return false;
	const struct rb_joint_piece *piece = &scan->piece[item->piece];
	item->part.shape.radius = piece->radius;
	item->part.shape.size[2] = piece->length;
	item->size = rb_part_size(model->scene, &item->part.shape);
	*pose = piece->pose;
	return true;
}

/* Fills the instance of an item and its place in the order. */
static void see_item(struct rb_solids *solids, const struct scan *scan, int k, rb_pose pose)
{
	const struct rb_view *view = scan->view;
	const struct item *item = &solids->item[k];
	const struct rb_look *look = &solids->setup.looks->of[item->index];
	const rb_vec3 middle = rb_quat_rotate(pose.orientation, item->size.middle);
	const rb_vec3 centre = rb_view_point(view, rb_vec3_add(pose.position, middle));
	const double distance = rb_view_distance(view, centre);
	const double least = 0.5 * LEAST_PX * rb_view_pixel_at(view, distance);
	const rb_mat3 turn = rb_view_turn(view, pose.orientation);
	const rb_quat q = rb_quat_unit(rb_quat_multiply(scan->to_view, pose.orientation));
	struct instance *to = &solids->instance[k];

	fill(to, item, look, centre, least);
	to->turn[0] = (float)q.x;
	to->turn[1] = (float)q.y;
	to->turn[2] = (float)q.z;
	to->turn[3] = (float)q.w;
	surround(solids, item, centre, &turn);
	solids->around[k] = (struct rb_apart_ball){.centre = centre,
	                                           .radius = fmax(item->size.reach, least)};
	const int bucket = item->batch * BUCKETS +
	                   bucket_of(item, view, &scan->edges, centre, least);
	solids->order[solids->shown++] = (struct rb_sort_item){
		(uint64_t)bucket << 32 | bits_of(distance), (uint64_t)k};
}

static void gather(struct rb_solids *solids, const struct rb_frame *frame,
                   const struct rb_view *view)
{
	struct scan scan = {.frame = frame,
	                    .view = view,
	                    .edges = rb_view_edges(view),
	                    .to_view = rb_view_quat(view)};

	solids->moving_corners = solids->still_corners = solids->shown = 0;
	for (int k = 0; k < solids->count; k++) {
		rb_pose pose;

		solids->around[k] = (struct rb_apart_ball){.radius = 0};
		if (place_item(solids, &scan, &solids->item[k], &pose))
			see_item(solids, &scan, k, pose);
	}
}

enum rb_status rb_solids_see(struct rb_solids *solids, const struct rb_frame *frame,
                             const struct rb_view *view, struct rb_error *err)
{
	int next = 0;

	if (solids->count == 0)
		return RB_OK;
	gather(solids, frame, view);
	rb_sort_by_key(solids->order, solids->scratch, (size_t)solids->shown);
	for (int b = 0; b < solids->batch_count; b++)
		for (int k = 0; k <= BUCKETS; k++) {
			solids->batch[b].first[k] = next;
			while (k < BUCKETS && next < solids->shown &&
			       (int)(solids->order[next].key >> 32) == b * BUCKETS + k) {
				solids->sorted[next] = solids->instance[solids->order[next].value];
				next++;
			}
		}
	glBindBuffer(GL_ARRAY_BUFFER, solids->instances);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)((size_t)solids->shown * sizeof *solids->sorted),
	             solids->sorted, GL_STREAM_DRAW);
	return rb_canvas_check("gather solids", err);
}

void rb_solids_casters(const struct rb_solids *solids, struct rb_casters *casters)
{
	const float(*corner)[4] = (const float(*)[4])solids->corner;

	casters->solids = corner;
	casters->solid_corner_count = solids->moving_corners;
	casters->still = corner + (8 * solids->count - solids->still_corners);
	casters->still_count = solids->still_corners;
}

/* ---- drawing ---- */

/* One instanced draw call. */
static void draw_some(const struct rb_solids *solids, const struct rb_mesh_range *mesh, int from,
                      int to)
{
	static const size_t places[INSTANCE_PLACES] = {
		offsetof(struct instance, centre), offsetof(struct instance, turn),
		offsetof(struct instance, scale), offsetof(struct instance, colour),
		offsetof(struct instance, count)};

	if (from == to)
		return;
	glBindBuffer(GL_ARRAY_BUFFER, solids->instances);
	for (GLuint k = 0; k < INSTANCE_PLACES; k++) {
		const size_t at = (size_t)from * sizeof(struct instance) + places[k];
		glVertexAttribPointer(VERTEX_PLACES + k, 4, GL_FLOAT, GL_FALSE,
		                      sizeof(struct instance), (const void *)at);
	}
	glDrawElementsInstanced(GL_TRIANGLES, mesh->count, GL_UNSIGNED_INT,
	                        (const void *)(mesh->first * sizeof(uint32_t)), to - from);
}

/* Size of a texel of a map, m; of a lamp's at its farthest. */
static double texel_of(const struct rb_solids *solids, const struct rb_shadow_fit *fit)
{
	const float *m = fit->to_map;
	const rb_vec3 across = {(double)m[0], (double)m[4], (double)m[8]};
	double farthest = fit->source[3] > 0 ? 0 : 1;

	for (int k = 0; k < solids->shown && fit->source[3] > 0; k++) {
		const float *c = solids->sorted[k].centre;
		farthest = fmax(farthest,
		                (double)(m[3] * c[0] + m[7] * c[1] + m[11] * c[2] + m[15]));
	}
	return 2 * farthest / (rb_vec3_length(across) * fit->side);
}

/*
 * Sides that are turned away from the light throw the shadow: what is lit lies before them, by the
 * body's width, and what lies in its own shadow gets no light anyhow. Foils have no such width;
 * they are pushed back like rectangles.
 */
void rb_solids_throw(const struct rb_solids *solids, const struct rb_shadow_fit *fit)
{
	const GLuint program = solids->setup.programs->solid_shadow;

	if (solids->count == 0)
		return;
	const double thin = THIN_TEXELS * texel_of(solids, fit);
	glBindVertexArray(solids->array);
	glUseProgram(program);
	glUniformMatrix4fv(rb_glsl_place(program, "to_map"), 1, GL_FALSE, fit->to_map);
	glEnable(GL_CULL_FACE);
	glCullFace(GL_FRONT);
	glEnable(GL_POLYGON_OFFSET_FILL);
	for (int b = 0; b < solids->batch_count; b++) {
		const struct batch *batch = &solids->batch[b];
		const bool is_thin = 2 * batch->half_width < thin;
		glPolygonOffset(is_thin ? 3 : 0.5F, is_thin ? 4 : 1);
		for (int k = 0; k < BUCKETS; k++)
			draw_some(solids, &batch->mesh[k == OUT_OF_VIEW ? FINENESS_OUT : k],
			          batch->first[k], batch->first[k + 1]);
	}
	glDisable(GL_POLYGON_OFFSET_FILL);
	glDisable(GL_CULL_FACE);
}

void rb_solids_draw(const struct rb_solids *solids)
{
	if (solids->count == 0)
		return;
	glBindVertexArray(solids->array);
	/* In pictures y points downwards, which turns triangles round. */
	glEnable(GL_CULL_FACE);
	glCullFace(GL_FRONT);
	for (int b = 0; b < solids->batch_count; b++) {
		const struct batch *batch = &solids->batch[b];
		if (batch->pattern == RB_PATTERN_IMAGE)
			glBindTexture(GL_TEXTURE_2D, solids->setup.texture[batch->image]);
		glUseProgram(solids->setup.programs->solid[batch->pattern]);
		for (int k = 0; k < FINENESSES; k++)
			draw_some(solids, &batch->mesh[k], batch->first[k], batch->first[k + 1]);
	}
	glDisable(GL_CULL_FACE);
}
