/* SPDX-License-Identifier: MIT */
#include "film/bodies.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "film/glsl.h"
#include "film/hidden.h"
#include "math/quat.h"

enum {
	SIZES = 3, /* of spheres in the picture */
	DISC_SIZES = 4,
	IMAGE_UNIT = 8, /* behind the shadow maps */
	DEFINES_BYTES = 1600
};
enum pass { BODY, RIM, PASS_COUNT };

/* Up to a radius in pixels: how many corners the polygons have, and whether shadows are looked at closely. */
static const struct {
	double most_px;
	int corners, ring_corners;
	bool fine;
} sizes[SIZES] = {{4, 4, 6, false}, {24, 8, 14, false}, {(double)INFINITY, 8, 48, true}};
/* Smaller ones are drawn as large as this: what flies away stays in sight as a dot. */
static const double LEAST_PX = 0.6;

/* Polygons instead of circles in a shadow map are off by less than half a texel. */
static const int disc_corners[DISC_SIZES] = {8, 16, 28, 64};
static const double disc_most_px[DISC_SIZES] = {3, 16, 60, (double)INFINITY};

/* An infinite plane or a rectangle that may be drawn. */
struct surface {
	int index;
	bool infinite;
	bool shown; /* in this view */
	float corner[6][4], normal[4], axis_u[4], axis_v[4];
	int corner_count;
};

struct surface_program {
	GLuint name; /* 0: not made */
	GLint corner, normal, axis_u, axis_v, paint, other;
};

struct rb_bodies {
	struct rb_bodies_setup setup;
	int *sphere; /* [sphere_count]: indices of spheres that are drawn at all, owned */
	int sphere_count, group_count;
	struct rb_sort_item *order, *scratch; /* [sphere_count], owned */
	struct rb_ball *ball;                 /* [sphere_count]: as gathered, owned */
	struct rb_ball *sorted;               /* [sphere_count]: by group, far ones first, owned */
	int *group_first;             /* [group_count + 2], owned; the last group is out of view */
	float (*rectangle_corner)[4]; /* [4 * rectangle_count], owned */
	int rectangle_count, caster_rectangles;
	struct surface *surface; /* [surface_count], owned */
	int surface_count;

	struct rb_hidden hidden;
	bool cut; /* near and far are the camera's: spheres may be open, and hide nothing */

	GLuint ball_buffer, ball_array, no_array;
	GLuint sphere_program[RB_PATTERN_COUNT][SIZES][PASS_COUNT];
	struct surface_program surface_program[RB_PATTERN_COUNT][2][2]; /* infinite? glossy? */
	GLuint disc_program[DISC_SIZES], flat_program;
	GLuint *texture; /* [image_count], owned */
};

/* ---- programs ---- */

static void say_lights(char *text, size_t room, const struct rb_lights *lights)
{
	size_t used = (size_t)snprintf(text, room, "#define LIGHTS ");

	for (int k = 0; k < lights->count; k++) {
		const struct rb_light *light = &lights->of[k];
		used += (size_t)snprintf(text + used, room - used,
		                         light->shadow ? "%s_SHADOW(%d, map%d) " : "%s(%d) ",
		                         light->lamp ? "LAMP" : "SUN", k, k);
	}
	snprintf(text + used, room - used, "\n");
}

static void say_samples(char *text, size_t room, const struct rb_canvas *canvas)
{
	const float(*at)[2] = rb_canvas_sample_positions(canvas);
	size_t used = (size_t)snprintf(text, room, "#define SAMPLES ");

	for (int k = 0; k < rb_canvas_samples(canvas); k++)
		used += (size_t)snprintf(text + used, room - used, "AT(%d, %.6f, %.6f) ", k,
		                         (double)at[k][0] - 0.5, (double)at[k][1] - 0.5);
	snprintf(text + used, room - used, "\n");
}

/* Units of samplers never change. */
static void wire(GLuint program)
{
	char name[8] = "map0";

	glUseProgram(program);
	for (int k = 0; k < RB_CAMERA_LIGHTS_MAX; k++) {
		name[3] = (char)('0' + k);
		glUniform1i(rb_glsl_place(program, name), k);
	}
	glUniform1i(rb_glsl_place(program, "image"), IMAGE_UNIT);
	const GLuint block = glGetUniformBlockIndex(program, "Scene");
	if (block != GL_INVALID_INDEX)
		glUniformBlockBinding(program, block, 0);
}

static enum rb_status make_sphere_program(struct rb_bodies *bodies, enum rb_pattern pattern,
                                          int size, enum pass pass, struct rb_error *err)
{
	char defines[DEFINES_BYTES], lights[400], samples[1000] = "";

	say_lights(lights, sizeof lights, bodies->setup.lights);
	if (rb_canvas_samples(bodies->setup.canvas) > 0)
		say_samples(samples, sizeof samples, bodies->setup.canvas);
	snprintf(defines, sizeof defines,
	         "#define PATTERN %d\n#define GLOSS\n#define CORNERS %d\n%s%s%s%s%s%s",
	         (int)pattern, pass == RIM ? sizes[size].ring_corners : sizes[size].corners,
	         bodies->cut ? "#define CLIP\n" : "", sizes[size].fine ? "#define FINE\n" : "",
	         bodies->setup.soft ? "#define SOFT\n" : "",
	         pass == BODY ? ""
	         : size == 0  ? "#define RIM 0.0\n"
	                      : "#define RIM 1.0\n",
	         lights, samples);
	const struct rb_glsl_parts parts = {
		.name = "sphere",
		.defines = defines,
		.vertex = {rb_shader_scene, rb_shader_sphere_vertex},
		.fragment = {rb_shader_scene, rb_shader_light, rb_shader_pattern,
	                     rb_shader_sphere_fragment},
	};
	GLuint *program = &bodies->sphere_program[pattern][size][pass];
	const enum rb_status status = rb_glsl_program(program, &parts, err);
	if (status == RB_OK)
		wire(*program);
	return status;
}

static enum rb_status make_surface_program(struct rb_bodies *bodies, enum rb_pattern pattern,
                                           bool infinite, bool glossy, struct rb_error *err)
{
	struct surface_program *program = &bodies->surface_program[pattern][infinite][glossy];
	const bool grid = bodies->setup.camera->wireframe;
	char defines[DEFINES_BYTES], lights[400];

	say_lights(lights, sizeof lights, bodies->setup.lights);
	snprintf(defines, sizeof defines, "#define PATTERN %d\n#define FINE\n%s%s%s%s",
	         (int)pattern, glossy ? "#define GLOSS\n" : "", infinite ? "#define HAZE\n" : "",
	         grid ? "#define GRID\n" : "", lights);
	const struct rb_glsl_parts parts = {
		.name = "plane",
		.defines = defines,
		.vertex = {rb_shader_scene, rb_shader_plane_vertex},
		.fragment = {rb_shader_scene, rb_shader_light, rb_shader_pattern,
	                     rb_shader_plane_fragment},
	};
	const enum rb_status status = rb_glsl_program(&program->name, &parts, err);
	if (status != RB_OK)
		return status;
	wire(program->name);
	program->corner = rb_glsl_place(program->name, "corner");
	program->normal = rb_glsl_place(program->name, "normal");
	program->axis_u = rb_glsl_place(program->name, "axis_u");
	program->axis_v = rb_glsl_place(program->name, "axis_v");
	program->paint = rb_glsl_place(program->name, "paint");
	program->other = rb_glsl_place(program->name, "other");
	return RB_OK;
}

static enum rb_status make_shadow_programs(struct rb_bodies *bodies, struct rb_error *err)
{
	const char *fix = rb_canvas_depth_from_zero(bodies->setup.canvas)
	                          ? "gl_Position.z = 0.5 * (gl_Position.z + gl_Position.w);"
	                          : "";
	enum rb_status status = RB_OK;
	char defines[200];

	for (int k = 0; k < DISC_SIZES && status == RB_OK; k++) {
		const double angle = 2 * acos(-1) / disc_corners[k];
		/* A polygon of the area of its circle. */
		snprintf(defines, sizeof defines,
		         "#define CORNERS %d\n#define ROUND %.6f\n#define FIX_DEPTH %s\n",
		         disc_corners[k], sqrt(angle / sin(angle)), fix);
		const struct rb_glsl_parts parts = {
			.name = "disc",
			.defines = defines,
			.vertex = {rb_shader_scene, rb_shader_disc_vertex},
			.fragment = {rb_shader_nothing},
		};
		status = rb_glsl_program(&bodies->disc_program[k], &parts, err);
	}
	snprintf(defines, sizeof defines, "#define FIX_DEPTH %s\n", fix);
	const struct rb_glsl_parts parts = {
		.name = "flat",
		.defines = defines,
		.vertex = {rb_shader_scene, rb_shader_flat_vertex},
		.fragment = {rb_shader_nothing},
	};
	return status != RB_OK ? status : rb_glsl_program(&bodies->flat_program, &parts, err);
}

/* Only those that some body needs. */
static enum rb_status make_programs(struct rb_bodies *bodies, struct rb_error *err)
{
	const struct rb_looks *looks = bodies->setup.looks;
	bool any_shadow = false;
	enum rb_status status = RB_OK;

	for (int k = 0; k < bodies->sphere_count && status == RB_OK; k++) {
		const enum rb_pattern pattern = looks->of[bodies->sphere[k]].pattern;
		if (bodies->sphere_program[pattern][0][BODY])
			continue;
		for (int size = 0; size < SIZES && status == RB_OK; size++)
			status = make_sphere_program(bodies, pattern, size, BODY, err);
		for (int size = 0; size < SIZES && status == RB_OK && bodies->setup.soft; size++)
			status = make_sphere_program(bodies, pattern, size, RIM, err);
	}
	for (int k = 0; k < bodies->surface_count && status == RB_OK; k++) {
		const struct surface *surface = &bodies->surface[k];
		const struct rb_look *look = &looks->of[surface->index];
		const bool glossy = look->gloss > 0;
		if (!bodies->surface_program[look->pattern][surface->infinite][glossy].name)
			status = make_surface_program(bodies, look->pattern, surface->infinite,
			                              glossy, err);
	}
	for (int k = 0; k < bodies->setup.lights->count; k++)
		any_shadow |= bodies->setup.lights->of[k].shadow;
	if (any_shadow && status == RB_OK)
		status = make_shadow_programs(bodies, err);
	return status;
}

/* ---- set-up ---- */

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

static void make_textures(struct rb_bodies *bodies)
{
	const struct rb_looks *looks = bodies->setup.looks;

	glActiveTexture(GL_TEXTURE0 + IMAGE_UNIT);
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

static bool take_room(struct rb_bodies *bodies, const struct rb_model *model)
{
	const int total = model->body_count + model->static_count;
	int spheres = 0, others = 0;

	for (int i = 0; i < total; i++)
		*(model->shape[i].kind == RB_SHAPE_SPHERE ? &spheres : &others) += 1;
	const size_t n = (size_t)spheres;
	bodies->group_count = SIZES * (RB_PATTERN_IMAGE + bodies->setup.looks->image_count);
	bodies->sphere = rb_memory_take(n, sizeof *bodies->sphere);
	bodies->order = rb_memory_take(n, sizeof *bodies->order);
	bodies->scratch = rb_memory_take(n, sizeof *bodies->scratch);
	bodies->ball = rb_memory_take(n, sizeof *bodies->ball);
	bodies->sorted = rb_memory_take(n, sizeof *bodies->sorted);
	bodies->group_first = rb_memory_take((size_t)bodies->group_count + 2,
	                                     sizeof *bodies->group_first);
	bodies->surface = rb_memory_take((size_t)others, sizeof *bodies->surface);
	bodies->rectangle_corner = rb_memory_take((size_t)others,
	                                          4 * sizeof *bodies->rectangle_corner);
	bodies->texture = rb_memory_take((size_t)bodies->setup.looks->image_count,
	                                 sizeof *bodies->texture);
	return bodies->sphere && bodies->order && bodies->scratch && bodies->ball &&
	       bodies->sorted && bodies->group_first && bodies->surface &&
	       bodies->rectangle_corner && bodies->texture;
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
		if (kind == RB_SHAPE_SPHERE)
			bodies->sphere[bodies->sphere_count++] = i;
		else
			bodies->surface[bodies->surface_count++] = (struct surface){
				.index = i, .infinite = kind == RB_SHAPE_PLANE};
	}
	make_arrays(bodies);
	make_textures(bodies);
	enum rb_status status = make_programs(bodies, err);
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
	rb_memory_free(bodies->sphere);
	rb_hidden_release(&bodies->hidden);
	rb_memory_free(bodies->order);
	rb_memory_free(bodies->scratch);
	rb_memory_free(bodies->ball);
	rb_memory_free(bodies->sorted);
	rb_memory_free(bodies->group_first);
	rb_memory_free(bodies->surface);
	rb_memory_free(bodies->rectangle_corner);
	rb_memory_free(bodies->texture);
	rb_memory_free(bodies);
}

/* ---- what a view shows ---- */

struct edges {
	rb_vec3 normal[4]; /* inwards, unit */
};

static struct edges edges_of(const struct rb_view *view)
{
	const rb_vec3 zero = {0, 0, 0};
	return (struct edges){{
		rb_vec3_unit((rb_vec3){1, 0, view->left_slope}, zero),
		rb_vec3_unit((rb_vec3){-1, 0, -view->right_slope}, zero),
		rb_vec3_unit((rb_vec3){0, 1, view->bottom_slope}, zero),
		rb_vec3_unit((rb_vec3){0, -1, -view->top_slope}, zero),
	}};
}

static bool outside(const struct edges *edges, rb_vec3 centre, double radius)
{
	if (centre.z - radius > 0)
		return true;
	for (int k = 0; k < 4; k++)
		if (rb_vec3_dot(edges->normal[k], centre) < -radius)
			return true;
	return false;
}

static struct rb_ball ball_of(const struct rb_view *view, const struct rb_look *look,
                              rb_vec3 centre, double radius, rb_quat orientation)
{
	struct rb_ball ball;

	ball.centre[0] = (float)centre.x;
	ball.centre[1] = (float)centre.y;
	ball.centre[2] = (float)centre.z;
	ball.radius = (float)radius;
	if (look->pattern != RB_PATTERN_PLAIN) {
		const rb_mat3 turn = rb_view_turn(view, orientation);
		const rb_quat q = rb_quat_from_mat3(&turn);
		ball.turn[0] = (float)-q.x;
		ball.turn[1] = (float)-q.y;
		ball.turn[2] = (float)-q.z;
		ball.turn[3] = (float)q.w;
	} else {
		memset(ball.turn, 0, sizeof ball.turn);
	}
	memcpy(ball.colour, look->colour, sizeof ball.colour);
	ball.gloss = look->gloss;
	return ball;
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

static int group_of(const struct rb_look *look, double radius_px)
{
	int size = 0;

	while (radius_px > sizes[size].most_px)
		size++;
	return SIZES * ((int)look->pattern + (look->image > 0 ? look->image : 0)) + size;
}

/* Balls as they come, with their distances to be sorted by. */
static void gather(struct rb_bodies *bodies, const struct rb_frame *frame,
                   const struct rb_view *view)
{
	const struct rb_model *model = bodies->setup.model;
	const double least = LEAST_PX * rb_view_pixel_size(view);

	for (int k = 0; k < bodies->sphere_count; k++) {
		const int index = bodies->sphere[k];
		const rb_pose pose = pose_by_index(model, frame, index);
		const rb_vec3 centre = rb_view_point(view, pose.position);
		const double distance = rb_vec3_length(centre);
		const double radius = fmax(model->shape[index].radius, least * distance);
		bodies->ball[k] = ball_of(view, &bodies->setup.looks->of[index], centre, radius,
		                          pose.orientation);
		bodies->order[k] = (struct rb_sort_item){bits_of(distance), (uint64_t)k};
	}
	rb_sort_by_key(bodies->order, bodies->scratch, (size_t)bodies->sphere_count);
}

/* What has no pixel in the picture goes to the last group: it throws shadows all the same. */
static void see_spheres(struct rb_bodies *bodies, const struct rb_frame *frame,
                        const struct rb_view *view)
{
	const struct edges edges = edges_of(view);
	const double pixel = rb_view_pixel_size(view);
	int *first = bodies->group_first, next = 0;

	gather(bodies, frame, view);
	rb_hidden_clear(&bodies->hidden);
	for (int k = 0; k < bodies->sphere_count; k++) {
		struct rb_sort_item *item = &bodies->order[k];
		const struct rb_ball *ball = &bodies->ball[item->value];
		const rb_vec3 centre = {(double)ball->centre[0], (double)ball->centre[1],
		                        (double)ball->centre[2]};
		const double radius = (double)ball->radius, px = pixel * rb_vec3_length(centre);
		int group = bodies->group_count;
		if (!outside(&edges, centre, radius + 2 * px) &&
		    (bodies->cut || !rb_hidden_add(&bodies->hidden, view, centre, radius)))
			group = group_of(&bodies->setup.looks->of[bodies->sphere[item->value]],
			                 radius / px);
		item->key = (uint64_t)group << 32 | (uint32_t)~item->key;
	}
	rb_sort_by_key(bodies->order, bodies->scratch, (size_t)bodies->sphere_count);
	for (int k = 0; k < bodies->sphere_count; k++) {
		const int group = (int)(bodies->order[k].key >> 32);
		while (next <= group)
			first[next++] = k;
		bodies->sorted[k] = bodies->ball[bodies->order[k].value];
	}
	while (next <= bodies->group_count + 1)
		first[next++] = bodies->sphere_count;
}

static void put(float to[4], rb_vec3 from, double last)
{
	to[0] = (float)from.x;
	to[1] = (float)from.y;
	to[2] = (float)from.z;
	to[3] = (float)last;
}

/* How textures lie on a surface: `side` is that of one of them. */
static void lay(struct surface *surface, const struct rb_looks *looks, const struct rb_shape *shape,
                const rb_mat3 *turn, rb_vec3 eye)
{
	const struct rb_look *look = &looks->of[surface->index];
	double side[2] = {looks->cell_m, looks->cell_m}, at[2] = {0, 0};
	const rb_vec3 u = {turn->m[0][0], turn->m[1][0], turn->m[2][0]};
	rb_vec3 v = {turn->m[0][1], turn->m[1][1], turn->m[2][1]};

	if (look->pattern == RB_PATTERN_IMAGE) {
		const struct rb_pixmap *image = &looks->images[look->image];
		side[0] = surface->infinite ? 4 * looks->cell_m : shape->size[0];
		side[1] = surface->infinite ? side[0] * image->height / image->width
		                            : shape->size[1];
		/* The picture's first row is its upper one. */
		v = rb_vec3_neg(v);
		eye.y = -eye.y;
		at[0] = at[1] = 0.5;
	}
	at[0] += eye.x / side[0];
	at[1] += eye.y / side[1];
	/* Patterns repeat after two squares; far from their origin there would be no digits left. */
	if (surface->infinite)
		for (int k = 0; k < 2; k++)
			at[k] -= 2 * floor(0.5 * at[k]);
	put(surface->axis_u, rb_vec3_scale(1 / side[0], u), at[0]);
	put(surface->axis_v, rb_vec3_scale(1 / side[1], v), at[1]);
}

static void see_surface(struct rb_bodies *bodies, struct surface *surface,
                        const struct rb_frame *frame, const struct rb_view *view)
{
	const struct rb_model *model = bodies->setup.model;
	const struct rb_shape *shape = &model->shape[surface->index];
	const rb_pose pose = pose_by_index(model, frame, surface->index);
	const rb_mat3 turn = rb_view_turn(view, pose.orientation);
	const rb_vec3 eye = rb_quat_rotate_back(pose.orientation,
	                                        rb_vec3_sub(view->eye, pose.position));
	const rb_vec3 n = {turn.m[0][2], turn.m[1][2], turn.m[2][2]};

	/* Edge-on there is nothing to see; from behind, an infinite plane is a wall that one looks through into its room. */
	surface->shown = surface->infinite ? eye.z > 0 : eye.z != 0;
	put(surface->normal, eye.z < 0 ? rb_vec3_neg(n) : n, fabs(eye.z));
	lay(surface, bodies->setup.looks, shape, &turn, eye);
	const rb_vec3 u = {turn.m[0][0], turn.m[1][0], turn.m[2][0]};
	const rb_vec3 v = {turn.m[0][1], turn.m[1][1], turn.m[2][1]};
	if (surface->infinite) {
		const rb_vec3 foot = rb_vec3_scale(-eye.z, n);
		put(surface->corner[0], foot, 1);
		for (int k = 0; k < 5; k++) {
			const double angle = 0.5 * acos(-1) * k;
			put(surface->corner[k + 1],
			    rb_vec3_add(rb_vec3_scale(cos(angle), u), rb_vec3_scale(sin(angle), v)),
			    0);
		}
		surface->corner_count = 6;
		return;
	}
	const rb_vec3 centre = rb_view_point(view, pose.position);
	float(*caster)[4] = &bodies->rectangle_corner[4 * (size_t)bodies->caster_rectangles++];
	for (int k = 0; k < 4; k++) {
		const double x = (k == 0 || k == 3 ? -0.5 : 0.5) * shape->size[0];
		const double y = (k < 2 ? -0.5 : 0.5) * shape->size[1];
		put(surface->corner[k],
		    rb_vec3_add(centre, rb_vec3_add(rb_vec3_scale(x, u), rb_vec3_scale(y, v))), 1);
		memcpy(caster[k], surface->corner[k], sizeof caster[k]);
	}
	surface->corner_count = 4;
}

enum rb_status rb_bodies_see(struct rb_bodies *bodies, const struct rb_frame *frame,
                             const struct rb_view *view, struct rb_error *err)
{
	see_spheres(bodies, frame, view);
	bodies->caster_rectangles = 0;
	for (int k = 0; k < bodies->surface_count; k++)
		see_surface(bodies, &bodies->surface[k], frame, view);
	glBindBuffer(GL_ARRAY_BUFFER, bodies->ball_buffer);
	glBufferData(GL_ARRAY_BUFFER,
	             (GLsizeiptr)((size_t)bodies->sphere_count * sizeof *bodies->sorted),
	             bodies->sorted, GL_STREAM_DRAW);
	return rb_canvas_check("gather bodies", err);
}

struct rb_casters rb_bodies_casters(const struct rb_bodies *bodies)
{
	return (struct rb_casters){
		.balls = bodies->sorted ? bodies->sorted[0].centre : NULL,
		.ball_count = bodies->sphere_count,
		.stride = sizeof *bodies->sorted / sizeof(float),
		.corners = (const float(*)[4])bodies->rectangle_corner,
		.corner_count = 4 * bodies->caster_rectangles,
	};
}

/* ---- drawing ---- */

/* Spheres from..to of the sorted ones become those of the next draw call. */
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

/* Discs of all spheres with as many corners as the largest needs: shadows of groups of like size are the rule. */
static void throw_spheres(const struct rb_bodies *bodies, const struct rb_shadow_fit *fit)
{
	const int *first = bodies->group_first;
	const double scale = (double)fabsf(fit->to_map[0]) + (double)fabsf(fit->to_map[4]) +
	                     (double)fabsf(fit->to_map[8]);

	for (int g = 0; g <= bodies->group_count; g++) {
		const int from = first[g], to = first[g + 1];
		double largest = 0;
		int size = 0;
		if (to <= from)
			continue;
		for (int k = from; k < to; k++)
			largest = fmax(largest, (double)bodies->sorted[k].radius);
		const double texels = fit->source[3] > 0 ? (double)INFINITY
		                                         : largest * scale * fit->side;
		while (texels > disc_most_px[size])
			size++;
		const GLuint program = bodies->disc_program[size];
		point_at(bodies, from);
		glUseProgram(program);
		glUniformMatrix4fv(rb_glsl_place(program, "to_map"), 1, GL_FALSE, fit->to_map);
		glUniform4fv(rb_glsl_place(program, "source"), 1, fit->source);
		glDrawArraysInstanced(GL_TRIANGLE_FAN, 0, disc_corners[size], to - from);
	}
}

void rb_bodies_throw(struct rb_bodies *bodies, const struct rb_shadow_fit *fit)
{
	throw_spheres(bodies, fit);
	glBindVertexArray(bodies->no_array);
	glUseProgram(bodies->flat_program);
	glUniformMatrix4fv(rb_glsl_place(bodies->flat_program, "to_map"), 1, GL_FALSE, fit->to_map);
	/* A rectangle lies in its own shadow: pushed back by what its slope is across the filter. */
	glEnable(GL_POLYGON_OFFSET_FILL);
	glPolygonOffset(3, 4);
	for (int k = 0; k < bodies->caster_rectangles; k++) {
		glUniform4fv(rb_glsl_place(bodies->flat_program, "corner"), 4,
		             bodies->rectangle_corner[4 * (size_t)k]);
		glDrawArrays(GL_TRIANGLE_FAN, 0, 4);
	}
	glDisable(GL_POLYGON_OFFSET_FILL);
}

static void draw_spheres(const struct rb_bodies *bodies, enum pass pass)
{
	const int *first = bodies->group_first;

	for (int g = 0; g < bodies->group_count; g++) {
		const int count = first[g + 1] - first[g], look = g / SIZES, size = g % SIZES;
		const int pattern = look < RB_PATTERN_IMAGE ? look : RB_PATTERN_IMAGE;
		if (count == 0)
			continue;
		if (pattern == RB_PATTERN_IMAGE)
			glBindTexture(GL_TEXTURE_2D, bodies->texture[look - RB_PATTERN_IMAGE]);
		point_at(bodies, first[g]);
		glUseProgram(bodies->sphere_program[pattern][size][pass]);
		if (pass == RIM)
			glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0,
			                      2 * (sizes[size].ring_corners + 1), count);
		else
			glDrawArraysInstanced(GL_TRIANGLE_FAN, 0, sizes[size].corners, count);
	}
}

static void draw_surface(const struct rb_bodies *bodies, const struct surface *surface)
{
	const struct rb_look *look = &bodies->setup.looks->of[surface->index];
	const struct surface_program *program =
		&bodies->surface_program[look->pattern][surface->infinite][look->gloss > 0];

	if (look->pattern == RB_PATTERN_IMAGE)
		glBindTexture(GL_TEXTURE_2D, bodies->texture[look->image]);
	glUseProgram(program->name);
	glUniform4fv(program->corner, surface->corner_count, surface->corner[0]);
	glUniform4fv(program->normal, 1, surface->normal);
	glUniform4fv(program->axis_u, 1, surface->axis_u);
	glUniform4fv(program->axis_v, 1, surface->axis_v);
	glUniform4f(program->paint, look->colour[0], look->colour[1], look->colour[2], look->gloss);
	glUniform4f(program->other, look->other[0], look->other[1], look->other[2], 0);
	glDrawArrays(GL_TRIANGLE_FAN, 0, surface->corner_count);
}

void rb_bodies_draw(struct rb_bodies *bodies)
{
	glActiveTexture(GL_TEXTURE0 + IMAGE_UNIT);
	glEnable(GL_DEPTH_TEST);
	if (!bodies->setup.camera->wireframe)
		draw_spheres(bodies, BODY);
	glBindVertexArray(bodies->no_array);
	for (int k = 0; k < bodies->surface_count; k++)
		if (bodies->surface[k].shown)
			draw_surface(bodies, &bodies->surface[k]);
}

void rb_bodies_soften(struct rb_bodies *bodies)
{
	glActiveTexture(GL_TEXTURE0 + IMAGE_UNIT);
	if (bodies->setup.soft)
		draw_spheres(bodies, RIM);
}
