/* SPDX-License-Identifier: MIT */
/*
 * Spheres are drawn as instanced discs whose fragments intersect the ray with the sphere
 * (impostors), sorted by groups of one shader program and within a group from near to far, so that
 * early depth tests reject what is hidden. Three exact tests thin them out beforehand: outside of
 * the view, behind an infinite plane, behind spheres already listed (film/hidden). Only spheres
 * that cut something need per-fragment depths (film/isolated), which switch early tests off.
 *
 * Soft edges are a second pass over the rims from far to near with blending: multisampling alone
 * leaves steps on small discs.
 */
#include "film/bodies.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "film/isolated.h"
#include "film/glsl.h"
#include "film/hidden.h"
#include "film/programs.h"
#include "film/solid_shapes.h"
#include "film/surfaces.h"
#include "force/spring.h"
#include "math/quat.h"
#include "model/shape.h"

/* A group has one pattern or picture, one size class, and is exact or not: one program each. */
enum { GROUPS_PER_LOOK = 2 * RB_BALL_SIZES };

/* Smallest radius drawn, px: what flies away stays visible as a dot. */
static const double LEAST_PX = 0.6;

/* A sphere that is drawn at all. */
struct orb {
	int index;                        /* of its body */
	const struct rb_solid_part *part; /* of a union, the scene's; NULL: the body itself */
};

struct rb_bodies {
	struct rb_bodies_setup setup;
	struct orb *sphere; /* [sphere_count], owned */
	int sphere_count, group_count;
	struct rb_sort_item *order, *scratch; /* [sphere_count], owned */
	struct rb_ball *ball;                 /* [sphere_count]: as gathered, owned */
	struct rb_ball *
		/* [2 sphere_count]: by group, near ones first; then far ones first; owned */
		sorted;
	struct rb_apart_ball *seen;   /* [sphere_count]: those in the picture; then solids; owned */
	int *group_first;             /* [group_count + 2], owned; the last group is out of view */
	float (*rectangle_corner)[4]; /* [4 * rectangle_count], owned */
	int rectangle_count, caster_rectangles;
	struct rb_surface *surface; /* [surface_count], owned */
	int surface_count;
	bool walls_cut;           /* planes no longer hide all that is behind them */
	struct rb_solids *solids; /* owned */

	struct rb_hidden hidden;
	struct rb_apart apart;
	bool cut;   /* near and far are the camera's: spheres may be open, and hide nothing */
	bool exact; /* all spheres have depths of their own */

	struct rb_programs programs;
	GLuint ball_buffer, ball_array, no_array;
	GLuint *texture; /* [image_count], owned */
};

/* ---- set-up ---- */

/* Vertex arrays: one without attributes for surfaces, one with three per-instance attributes. */
static void make_arrays(struct rb_bodies *bodies)
{
	glGenVertexArrays(1, &bodies->no_array);
	glGenVertexArrays(1, &bodies->ball_array);
	glGenBuffers(1, &bodies->ball_buffer);
	glBindVertexArray(bodies->ball_array);
	for (GLuint k = 0; k < 3; k++) {
		glEnableVertexAttribArray(k);
		glVertexAttribDivisor(k, 1);
	}
}

/* Uploads the pictures with mipmaps, sRGB decoded by the sampler. */
static void make_textures(struct rb_bodies *bodies)
{
	const struct rb_looks *looks = bodies->setup.looks;

	glActiveTexture(GL_TEXTURE0 + RB_IMAGE_UNIT);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glGenTextures(looks->image_count, bodies->texture);
	for (int k = 0; k < looks->image_count; k++) {
		const struct rb_pixmap *image = &looks->images[k];
		glBindTexture(GL_TEXTURE_2D, bodies->texture[k]);
		glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, image->width, image->height, 0,
		             GL_RGBA, GL_UNSIGNED_BYTE, image->rgba);
		glGenerateMipmap(GL_TEXTURE_2D);
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
	}
}

/* Spheres, in unions too; `sphere` NULL: only counts. */
static int list_spheres(const struct rb_model *model, const struct rb_looks *looks,
                        struct orb *sphere)
{
	int count = 0;

	for (int i = 0; i < model->body_count + model->static_count; i++) {
		const struct rb_shape *shape = &model->shape[i];
		struct rb_solid_part own;
		int part_count;
		const struct rb_solid_part *parts = rb_parts_of(model->scene, shape, &own,
		                                                &part_count);
		for (int p = 0; p < part_count && looks->of[i].visible; p++) {
			if (rb_shape_type(&parts[p].shape)->form != RB_FORM_BALL)
				continue;
			if (sphere)
				sphere[count] = (struct orb){i, parts == &own ? NULL : &parts[p]};
			count++;
		}
	}
	return count;
}

/* Allocates for all bodies, so that drawing allocates nothing; false when memory is out. */
static bool take_room(struct rb_bodies *bodies, const struct rb_model *model)
{
	const int total = model->body_count + model->static_count;
	int others = 0;

	for (int i = 0; i < total; i++)
		others += rb_shape_type(&model->shape[i])->form == RB_FORM_SURFACE;
	const int solids = rb_solids_number(model, bodies->setup.looks);
	const size_t n = (size_t)list_spheres(model, bodies->setup.looks, NULL);
	bodies->group_count = GROUPS_PER_LOOK *
	                      (RB_PATTERN_IMAGE + bodies->setup.looks->image_count);
	bodies->sphere = rb_memory_take(n, sizeof *bodies->sphere);
	bodies->order = rb_memory_take(n, sizeof *bodies->order);
	bodies->scratch = rb_memory_take(n, sizeof *bodies->scratch);
	bodies->ball = rb_memory_take(n, sizeof *bodies->ball);
	bodies->sorted = rb_memory_take(2 * n, sizeof *bodies->sorted);
	bodies->seen = rb_memory_take(n + (size_t)solids, sizeof *bodies->seen);
	bodies->group_first = rb_memory_take((size_t)bodies->group_count + 2,
	                                     sizeof *bodies->group_first);
	bodies->surface = rb_memory_take((size_t)others, sizeof *bodies->surface);
	bodies->rectangle_corner = rb_memory_take((size_t)others,
	                                          4 * sizeof *bodies->rectangle_corner);
	bodies->texture = rb_memory_take((size_t)bodies->setup.looks->image_count,
	                                 sizeof *bodies->texture);
	return bodies->sphere && bodies->order && bodies->scratch && bodies->ball &&
	       bodies->sorted && bodies->seen && bodies->group_first && bodies->surface &&
	       bodies->rectangle_corner && bodies->texture;
}

/*
 * Compiles programs for surfaces and shadows; those of spheres are compiled when first needed,
 * since there are many combinations.
 */
static enum rb_status prepare_programs(struct rb_bodies *bodies, struct rb_error *err)
{
	const struct rb_bodies_setup *setup = &bodies->setup;
	bool any_shadow = false;
	enum rb_status status = RB_OK;

	bodies->programs = (struct rb_programs){.lights = setup->lights,
	                                        .canvas = setup->canvas,
	                                        .soft = setup->soft,
	                                        .cut = bodies->cut,
	                                        .grid = setup->camera->wireframe};
	for (int k = 0; k < bodies->surface_count && status == RB_OK; k++) {
		const struct rb_surface *surface = &bodies->surface[k];
		const struct rb_look *look = &setup->looks->of[surface->index];
		status = rb_programs_surface(&bodies->programs, look->pattern, surface->infinite,
		                             look->gloss > 0, err);
	}
	for (int k = 0; k < setup->lights->count; k++)
		any_shadow |= setup->lights->of[k].shadow;
	return any_shadow && status == RB_OK ? rb_programs_shadows(&bodies->programs, err) : status;
}

enum rb_status rb_bodies_create(struct rb_bodies **bodies_out, const struct rb_bodies_setup *setup,
                                struct rb_error *err)
{
	const struct rb_model *model = setup->model;

	*bodies_out = NULL;
	struct rb_bodies *bodies = rb_memory_take(1, sizeof *bodies);
	if (bodies)
		bodies->setup = *setup;
	if (!bodies || !take_room(bodies, model) ||
	    rb_hidden_init(&bodies->hidden, setup->camera->size_px[0], setup->camera->size_px[1],
	                   NULL) != RB_OK) {
		rb_bodies_destroy(bodies);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw %d bodies: out of memory",
		               model->body_count + model->static_count);
	}
	bodies->cut = setup->camera->has_frustum || !isnan(setup->camera->near) ||
	              !isnan(setup->camera->far);
	for (int i = 0; i < model->body_count + model->static_count; i++) {
		const enum rb_shape_kind kind = model->shape[i].kind;
		if (!setup->looks->of[i].visible)
			continue;
		if (kind == RB_SHAPE_PLANE || kind == RB_SHAPE_RECTANGLE)
			bodies->surface[bodies->surface_count++] = (struct rb_surface){
				.index = i, .infinite = kind == RB_SHAPE_PLANE};
	}
	RB_ASSERT(bodies->surface_count <= model->body_count + model->static_count);
	bodies->sphere_count = list_spheres(model, setup->looks, bodies->sphere);
	rb_apart_init(&bodies->apart);
	/* Trails and springs go through spheres. */
	bodies->exact = bodies->cut || setup->camera->trail_count > 0 ||
	                rb_scene_element_count(model->scene, &rb_force_spring) > 0;
	make_arrays(bodies);
	make_textures(bodies);
	enum rb_status status = prepare_programs(bodies, err);
	const struct rb_solids_setup solids = {.model = model,
	                                       .looks = setup->looks,
	                                       .programs = &bodies->programs,
	                                       .texture = bodies->texture};
	if (status == RB_OK)
		status = rb_solids_create(&bodies->solids, &solids, err);
	if (status == RB_OK)
		status = rb_canvas_check("prepare bodies", err);
	if (status != RB_OK) {
		rb_bodies_destroy(bodies);
		return status;
	}
	*bodies_out = bodies;
	return RB_OK;
}

void rb_bodies_destroy(struct rb_bodies *bodies)
{
	if (!bodies)
		return;
	/* Names of OpenGL go with the canvas. */
	rb_solids_destroy(bodies->solids);
	rb_memory_free(bodies->sphere);
	rb_hidden_release(&bodies->hidden);
	rb_memory_free(bodies->order);
	rb_memory_free(bodies->scratch);
	rb_memory_free(bodies->ball);
	rb_memory_free(bodies->sorted);
	rb_memory_free(bodies->seen);
	rb_apart_release(&bodies->apart);
	rb_memory_free(bodies->group_first);
	rb_memory_free(bodies->surface);
	rb_memory_free(bodies->rectangle_corner);
	rb_memory_free(bodies->texture);
	rb_memory_free(bodies);
}

/* ---- what a view shows ---- */

/*
 * Instance data of a sphere; without a pattern its orientation is zeroed, so that equal spheres
 * have equal data.
 */
static struct rb_ball ball_of(const struct rb_look *look, rb_vec3 centre, double radius,
                              rb_quat orientation)
{
	struct rb_ball ball;

	ball.centre[0] = (float)centre.x;
	ball.centre[1] = (float)centre.y;
	ball.centre[2] = (float)centre.z;
	ball.radius = (float)radius;
	if (look->pattern != RB_PATTERN_PLAIN) {
		ball.turn[0] = (float)-orientation.x;
		ball.turn[1] = (float)-orientation.y;
		ball.turn[2] = (float)-orientation.z;
		ball.turn[3] = (float)orientation.w;
	} else {
		memset(ball.turn, 0, sizeof ball.turn);
	}
	memcpy(ball.colour, look->colour, sizeof ball.colour);
	ball.gloss = look->gloss;
	return ball;
}

static rb_vec3 point_of(const float at[3])
{
	return (rb_vec3){(double)at[0], (double)at[1], (double)at[2]};
}

static rb_pose pose_by_index(const struct rb_model *model, const struct rb_frame *frame, int index)
{
	return rb_view_pose(model, frame, model->id_of[index]);
}

/* Bits of positive floats are in the order of their values. */
static uint32_t bits_of(double distance)
{
	const float value = (float)distance;
	uint32_t bits;

	memcpy(&bits, &value, sizeof bits);
	return bits;
}

/* Group of a sphere of that radius in px. */
static int group_of(const struct rb_look *look, double radius_px, bool exact)
{
	const int number = (int)look->pattern + (look->image > 0 ? look->image : 0);

	return GROUPS_PER_LOOK * number + 2 * rb_ball_size(radius_px) + exact;
}

/* Inverse of group_of, up to which picture it is. */
static struct rb_ball_kind kind_of(int group)
{
	RB_ASSERT_COSTLY(group >= 0);

	const int look = group / GROUPS_PER_LOOK;

	return (struct rb_ball_kind){
		.pattern = look < RB_PATTERN_IMAGE ? (enum rb_pattern)look : RB_PATTERN_IMAGE,
		.size = group % GROUPS_PER_LOOK / 2,
		.exact = group % 2 == 1,
	};
}

/* Instance data of all spheres, and their order by distance. */
static void gather(struct rb_bodies *bodies, const struct rb_frame *frame,
                   const struct rb_view *view)
{
	const struct rb_model *model = bodies->setup.model;
	for (int k = 0; k < bodies->sphere_count; k++) {
		const int index = bodies->sphere[k].index;
		const struct rb_solid_part *part = bodies->sphere[k].part;
		rb_pose pose = pose_by_index(model, frame, index);
		if (part)
			pose = rb_view_part(pose, part);
		const rb_vec3 centre = rb_view_point(view, pose.position);
		const double distance = rb_view_distance(view, centre);
		const double whole = part ? part->shape.radius : model->shape[index].radius;
		const double radius = fmax(whole, LEAST_PX * rb_view_pixel_at(view, distance));
		bodies->ball[k] = ball_of(&bodies->setup.looks->of[index], centre, radius,
		                          pose.orientation);
		bodies->order[k] = (struct rb_sort_item){bits_of(distance), (uint64_t)k};
	}
	rb_sort_by_key(bodies->order, bodies->scratch, (size_t)bodies->sphere_count);
}

/*
 * True if the sphere lies behind an infinite plane that is shown; sets ball->cuts where it cuts a
 * surface.
 */
static bool is_behind_surface(const struct rb_bodies *bodies, struct rb_apart_ball *ball)
{
	for (int k = 0; k < bodies->surface_count; k++) {
		const struct rb_surface *surface = &bodies->surface[k];
		if (!surface->shown)
			continue;
		if (!surface->infinite) {
			const rb_vec3 corner = point_of(surface->corner[0][0]);
			const rb_vec3 u = rb_vec3_sub(point_of(surface->corner[0][1]), corner);
			const rb_vec3 v = rb_vec3_sub(point_of(surface->corner[0][3]), corner);
			ball->cuts |= rb_apart_cuts_rectangle(ball, corner, u, v);
			continue;
		}
		const double height = rb_vec3_dot(point_of(surface->normal), ball->centre) +
		                      (double)surface->normal[3];
		if (height < -ball->radius && !bodies->walls_cut)
			return true;
		ball->cuts |= fabs(height) < rb_apart_part * ball->radius;
	}
	return false;
}

/* Distance bits of the k-th in order. */
static uint32_t key_of(const struct rb_bodies *bodies, int k)
{
	return (uint32_t)bodies->order[k].key;
}

/* Merges the exact and the plain group g into one with far spheres first, for blended rims. */
static void mirror(struct rb_bodies *bodies, int g)
{
	const int *first = bodies->group_first;
	int a = first[g + 1] - 1, b = first[g + 2] - 1;
	struct rb_ball *to = &bodies->sorted[bodies->sphere_count + first[g]];

	while (a >= first[g] || b >= first[g + 1]) {
		const bool take_a = b < first[g + 1] ||
		                    (a >= first[g] && key_of(bodies, a) >= key_of(bodies, b));
		*to++ = bodies->sorted[take_a ? a-- : b--];
	}
}

/* Sorts by group and distance and sets group_first. */
static void group(struct rb_bodies *bodies)
{
	int *first = bodies->group_first, next = 0;

	rb_sort_by_key(bodies->order, bodies->scratch, (size_t)bodies->sphere_count);
	for (int k = 0; k < bodies->sphere_count; k++) {
		const int group = (int)(bodies->order[k].key >> 32);
		while (next <= group)
			first[next++] = k;
		bodies->sorted[k] = bodies->ball[bodies->order[k].value];
	}
	while (next <= bodies->group_count + 1)
		first[next++] = bodies->sphere_count;
	RB_ASSERT(first[bodies->group_count + 1] == bodies->sphere_count);
	for (int g = 0; g < bodies->group_count && bodies->setup.soft; g += 2)
		mirror(bodies, g);
	RB_ASSERT(next == bodies->group_count + 2);
}

/*
 * Finds what is visible and what cuts. Spheres without a pixel in the picture go to the last group:
 * they still throw shadows.
 */
static enum rb_status see_spheres(struct rb_bodies *bodies, const struct rb_frame *frame,
                                  const struct rb_view *view, struct rb_error *err)
{
	const struct rb_view_edges edges = rb_view_edges(view);
	int seen = 0;

	gather(bodies, frame, view);
	rb_hidden_clear(&bodies->hidden);
	for (int k = 0; k < bodies->sphere_count; k++) {
		struct rb_sort_item *item = &bodies->order[k];
		const struct rb_ball *ball = &bodies->ball[item->value];
		struct rb_apart_ball *one = &bodies->seen[seen];
		*one = (struct rb_apart_ball){.centre = point_of(ball->centre),
		                              .radius = (double)ball->radius,
		                              .cuts = bodies->exact};
		const double px = rb_view_pixel_at(view, rb_vec3_length(one->centre));
		const bool out = rb_view_misses(&edges, one->centre, one->radius + 2 * px) ||
		                 is_behind_surface(bodies, one) ||
		                 (!bodies->cut &&
		                  rb_hidden_add(&bodies->hidden, view, one->centre, one->radius));
		item->key = (uint64_t)out << 32 | (uint32_t)item->key;
		seen += !out;
	}
	enum rb_status status = RB_OK;
	if (!bodies->exact && seen > 0) {
		const int solids = rb_solids_listed(bodies->solids);
		memcpy(bodies->seen + seen, rb_solids_around(bodies->solids),
		       (size_t)solids * sizeof *bodies->seen);
		status = rb_apart_find(&bodies->apart, bodies->seen, seen + solids, err);
	}
	seen = 0;
	for (int k = 0; k < bodies->sphere_count; k++) {
		struct rb_sort_item *item = &bodies->order[k];
		uint64_t number = (uint64_t)bodies->group_count;
		if (item->key >> 32 == 0) {
			const struct rb_apart_ball *one = &bodies->seen[seen++];
			const int index = bodies->sphere[item->value].index;
			number = (uint64_t)group_of(
				&bodies->setup.looks->of[index],
				one->radius / rb_view_pixel_at(view, rb_vec3_length(one->centre)),
				one->cuts);
		}
		item->key = number << 32 | (uint32_t)item->key;
	}
	group(bodies);
	return status;
}

/* Compiles the programs of groups that have spheres. */
static enum rb_status make_programs(struct rb_bodies *bodies, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	GLuint made;

	for (int g = 0; g < bodies->group_count && status == RB_OK; g++) {
		struct rb_ball_kind kind = kind_of(g);
		if (bodies->group_first[g] == bodies->group_first[g + 1])
			continue;
		status = rb_programs_ball(&bodies->programs, kind, &made, err);
		kind.exact = false;
		kind.rim = true;
		if (status == RB_OK && bodies->setup.soft)
			status = rb_programs_ball(&bodies->programs, kind, &made, err);
	}
	return status;
}

enum rb_status rb_bodies_see(struct rb_bodies *bodies, const struct rb_frame *frame,
                             const struct rb_view *view, struct rb_error *err)
{
	const size_t rows = (size_t)bodies->sphere_count * (bodies->setup.soft ? 2 : 1);

	bodies->caster_rectangles = 0;
	for (int k = 0; k < bodies->surface_count; k++) {
		struct rb_surface *surface = &bodies->surface[k];
		rb_surface_see(surface, bodies->setup.model, bodies->setup.looks, frame, view);
		if (!surface->infinite)
			memcpy(bodies->rectangle_corner[4 * (size_t)bodies->caster_rectangles++],
			       surface->corner[0], 4 * sizeof surface->corner[0][0]);
	}
	bodies->walls_cut = rb_surfaces_cut(bodies->surface, bodies->surface_count);
	enum rb_status status = rb_solids_see(bodies->solids, frame, view, err);
	if (status == RB_OK)
		status = see_spheres(bodies, frame, view, err);
	if (status == RB_OK)
		status = make_programs(bodies, err);
	if (status != RB_OK)
		return status;
	glBindBuffer(GL_ARRAY_BUFFER, bodies->ball_buffer);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(rows * sizeof *bodies->sorted), bodies->sorted,
	             GL_STREAM_DRAW);
	return rb_canvas_check("gather bodies", err);
}

struct rb_casters rb_bodies_casters(const struct rb_bodies *bodies)
{
	struct rb_casters casters = {
		.balls = bodies->sorted ? bodies->sorted[0].centre : NULL,
		.ball_count = bodies->sphere_count,
		.stride = sizeof *bodies->sorted / sizeof(float),
		.corners = (const float(*)[4])bodies->rectangle_corner,
		.corner_count = 4 * bodies->caster_rectangles,
	};

	rb_solids_casters(bodies->solids, &casters);
	return casters;
}

/* ---- drawing ---- */

/* Points the attributes at the sorted spheres from `from` on. */
static void point_at(const struct rb_bodies *bodies, int from)
{
	static const size_t places[3] = {offsetof(struct rb_ball, centre),
	                                 offsetof(struct rb_ball, turn),
	                                 offsetof(struct rb_ball, colour)};

	glBindVertexArray(bodies->ball_array);
	glBindBuffer(GL_ARRAY_BUFFER, bodies->ball_buffer);
	for (GLuint k = 0; k < 3; k++) {
		const size_t at = (size_t)from * sizeof(struct rb_ball) + places[k];
		glVertexAttribPointer(k, 4, GL_FLOAT, GL_FALSE, sizeof(struct rb_ball),
		                      (const void *)at);
	}
}

/*
 * Draws the spheres of each group into a shadow map as discs, with as many corners as the largest
 * of the group needs.
 */
static void throw_spheres(const struct rb_bodies *bodies, const struct rb_shadow_fit *fit)
{
	const int *first = bodies->group_first;
	const rb_vec3 across = {(double)fit->to_map[0], (double)fit->to_map[4],
	                        (double)fit->to_map[8]};
	const double scale = 0.5 * rb_vec3_length(across) * fit->side;

	for (int g = 0; g <= bodies->group_count; g++) {
		const int from = first[g], to = first[g + 1];
		double largest = 0;
		if (to <= from)
			continue;
		for (int k = from; k < to; k++)
			largest = fmax(largest, (double)bodies->sorted[k].radius);
		const double texels = fit->source[3] > 0 ? (double)INFINITY : largest * scale;
		const int size = rb_disc_size(texels);
		const GLuint program = bodies->programs.disc[size];
		point_at(bodies, from);
		glUseProgram(program);
		glUniformMatrix4fv(rb_glsl_place(program, "to_map"), 1, GL_FALSE, fit->to_map);
		glUniform4fv(rb_glsl_place(program, "source"), 1, fit->source);
		glDrawArraysInstanced(GL_TRIANGLE_FAN, 0, rb_disc_corners(size), to - from);
	}
}

void rb_bodies_throw(struct rb_bodies *bodies, const struct rb_shadow_fit *fit)
{
	throw_spheres(bodies, fit);
	rb_solids_throw(bodies->solids, fit);
	glBindVertexArray(bodies->no_array);
	glUseProgram(bodies->programs.flat);
	glUniformMatrix4fv(rb_glsl_place(bodies->programs.flat, "to_map"), 1, GL_FALSE,
	                   fit->to_map);
	/* A rectangle would shade itself: it is pushed back by its slope across the filter. */
	glEnable(GL_POLYGON_OFFSET_FILL);
	glPolygonOffset(3, 4);
	for (int k = 0; k < bodies->caster_rectangles; k++) {
		glUniform4fv(rb_glsl_place(bodies->programs.flat, "corner"), 4,
		             bodies->rectangle_corner[4 * (size_t)k]);
		glDrawArrays(GL_TRIANGLE_FAN, 0, 4);
	}
	glDisable(GL_POLYGON_OFFSET_FILL);
}

/* Binds the picture of a group that has one. */
static void use_picture(const struct rb_bodies *bodies, int group)
{
	const int image = group / GROUPS_PER_LOOK - RB_PATTERN_IMAGE;

	if (image >= 0)
		glBindTexture(GL_TEXTURE_2D, bodies->texture[image]);
}

static void draw_spheres(const struct rb_bodies *bodies)
{
	const int *first = bodies->group_first;

	glEnable(
		GL_DEPTH_CLAMP); /* what is nearer than `near` is no more cut than EXACT ones are */
	for (int g = 0; g < bodies->group_count; g++) {
		const struct rb_ball_kind kind = kind_of(g);
		if (first[g] == first[g + 1])
			continue;
		use_picture(bodies, g);
		point_at(bodies, first[g]);
		glUseProgram(bodies->programs.ball[kind.pattern][kind.size][kind.exact][false]);
		glDrawArraysInstanced(GL_TRIANGLE_FAN, 0, rb_ball_corners(kind.size),
		                      first[g + 1] - first[g]);
	}
	glDisable(GL_DEPTH_CLAMP);
}

static void draw_rims(const struct rb_bodies *bodies)
{
	const int *first = bodies->group_first;

	glEnable(GL_DEPTH_CLAMP);
	for (int g = 0; g < bodies->group_count; g += 2) {
		const struct rb_ball_kind kind = kind_of(g);
		if (first[g] == first[g + 2])
			continue;
		use_picture(bodies, g);
		point_at(bodies, bodies->sphere_count + first[g]);
		glUseProgram(bodies->programs.ball[kind.pattern][kind.size][false][true]);
		glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 2 * (rb_ring_corners(kind.size) + 1),
		                      first[g + 2] - first[g]);
	}
	glDisable(GL_DEPTH_CLAMP);
}

static void draw_surface(const struct rb_bodies *bodies, const struct rb_surface *surface)
{
	const struct rb_look *look = &bodies->setup.looks->of[surface->index];
	const struct rb_surface_program *program =
		&bodies->programs.surface[look->pattern][surface->infinite][look->gloss > 0];

	if (look->pattern == RB_PATTERN_IMAGE)
		glBindTexture(GL_TEXTURE_2D, bodies->texture[look->image]);
	glUseProgram(program->name);
	glUniform4fv(program->normal, 1, surface->normal);
	glUniform4fv(program->axis_u, 1, surface->axis_u);
	glUniform4fv(program->axis_v, 1, surface->axis_v);
	glUniform4f(program->paint, look->colour[0], look->colour[1], look->colour[2], look->gloss);
	glUniform4f(program->other, look->other[0], look->other[1], look->other[2], 0);
	for (int p = 0; p < surface->part_count; p++) {
		glUniform4fv(program->corner, surface->corner_count[p], surface->corner[p][0]);
		glDrawArrays(GL_TRIANGLE_FAN, 0, surface->corner_count[p]);
	}
}

void rb_bodies_draw(struct rb_bodies *bodies)
{
	glActiveTexture(GL_TEXTURE0 + RB_IMAGE_UNIT);
	glEnable(GL_DEPTH_TEST);
	if (!bodies->setup.camera->wireframe) {
		draw_spheres(bodies);
		rb_solids_draw(bodies->solids);
	}
	glBindVertexArray(bodies->no_array);
	for (int k = 0; k < bodies->surface_count; k++)
		if (bodies->surface[k].shown)
			draw_surface(bodies, &bodies->surface[k]);
}

void rb_bodies_soften(struct rb_bodies *bodies)
{
	glActiveTexture(GL_TEXTURE0 + RB_IMAGE_UNIT);
	if (bodies->setup.soft)
		draw_rims(bodies);
}
