/* SPDX-License-Identifier: MIT */
/*
 * Programs are compiled for each combination of pattern, size, precision and light: a rasteriser in
 * software pays for every instruction, so a program has only what its bodies need. Compiled on
 * first use.
 */
#include "film/programs.h"

#include <math.h>
#include <stdio.h>

#include "base/error.h"

enum { DEFINES_SIZE = RB_LIGHTS_DEFINES_SIZE + 1800 };

/*
 * By radius in pixels: corners of the polygon around a disc, of the ring around it, and the filter
 * of shadows. A corner costs as much as some 16 pixels.
 */
static const struct {
	double most_px;
	int corners, ring_corners;
	const char *filter;
} sizes[RB_BALL_SIZES] = {
	{4, 4, 4, ""}, {24, 6, 8, "#define FAIR\n"}, {(double)INFINITY, 8, 24, "#define FINE\n"}};

/*
 * Corners of discs in shadow maps by radius in texels: the polygon is off by less than half a
 * texel.
 */
static const int disc_corners[RB_DISC_SIZES] = {8, 12, 28, 64};
static const double disc_most_px[RB_DISC_SIZES] = {9, 20, 111, (double)INFINITY};

int rb_ball_size(double radius_px)
{
	int size = 0;

	while (radius_px > sizes[size].most_px)
		size++;
	return size;
}

int rb_ball_corners(int size)
{
	RB_ASSERT_COSTLY(size >= 0 && size < RB_BALL_SIZES);

	return sizes[size].corners;
}

int rb_ring_corners(int size)
{
	RB_ASSERT_COSTLY(size >= 0 && size < RB_BALL_SIZES);

	return sizes[size].ring_corners;
}

int rb_disc_size(double radius_texels)
{
	int size = 0;

	while (radius_texels > disc_most_px[size])
		size++;
	return size;
}

int rb_disc_corners(int size)
{
	RB_ASSERT_COSTLY(size >= 0 && size < RB_DISC_SIZES);

	return disc_corners[size];
}

/* Positions of the samples within a pixel, as a macro. */
static void say_samples(char *text, size_t room, const struct rb_canvas *canvas)
{
	const float(*at)[2] = rb_canvas_sample_positions(canvas);
	size_t used = (size_t)snprintf(text, room, "#define SAMPLES ");

	for (int k = 0; k < rb_canvas_samples(canvas); k++)
		used += (size_t)snprintf(text + used, room - used, "AT(%d, %.6f, %.6f) ", k,
		                         (double)at[k][0] - 0.5, (double)at[k][1] - 0.5);
	snprintf(text + used, room - used, "\n");
}

/* Binds samplers and the uniform block, which never change. */
static void wire(GLuint program)
{
	char name[8] = "map0";

	glUseProgram(program);
	for (int k = 0; k < RB_CAMERA_LIGHTS_MAX; k++) {
		name[3] = (char)('0' + k);
		glUniform1i(rb_glsl_place(program, name), k);
	}
	glUniform1i(rb_glsl_place(program, "image"), RB_IMAGE_UNIT);
	const GLuint block = glGetUniformBlockIndex(program, "Scene");
	if (block != GL_INVALID_INDEX)
		glUniformBlockBinding(program, block, 0);
}

/* Compiles one of the programs for spheres. */
static enum rb_status make_ball(const struct rb_programs *programs, struct rb_ball_kind kind,
                                GLuint *program, struct rb_error *err)
{
	char defines[DEFINES_SIZE], lights[RB_LIGHTS_DEFINES_SIZE], samples[1000] = "";

	rb_lights_define(programs->lights, true, lights, sizeof lights);
	if (rb_canvas_samples(programs->canvas) > 0)
		say_samples(samples, sizeof samples, programs->canvas);
	snprintf(defines, sizeof defines,
	         "#define PATTERN %d\n#define GLOSS\n#define CORNERS %d\n#define TEXEL %.9f\n"
	         "%s%s%s%s%s%s%s%s",
	         (int)kind.pattern,
	         kind.rim ? sizes[kind.size].ring_corners : sizes[kind.size].corners,
	         1.0 / RB_SHADOW_SIDE, programs->cut ? "#define CLIP\n" : "",
	         kind.rim ? "" : sizes[kind.size].filter, programs->soft ? "#define SOFT\n" : "",
	         kind.rim ? "#define RIM\n" : "", kind.exact ? "#define EXACT\n" : "",
	         /* rims are cut off at near and far too, though they have no depth of their own */
	         kind.exact || programs->cut ? "#define DEEP\n" : "", lights, samples);
	const struct rb_glsl_parts parts = {
		.name = "sphere",
		.defines = defines,
		.vertex = {rb_shader_scene, rb_shader_sphere_vertex},
		.fragment = {rb_shader_scene, rb_shader_light, rb_shader_pattern,
	                     rb_shader_sphere_fragment},
	};
	const enum rb_status status = rb_glsl_program(program, &parts, err);
	if (status == RB_OK)
		wire(*program);
	return status;
}

enum rb_status rb_programs_ball(struct rb_programs *programs, struct rb_ball_kind kind,
                                GLuint *program, struct rb_error *err)
{
	GLuint *const made = &programs->ball[kind.pattern][kind.size][kind.exact][kind.rim];
	enum rb_status status = RB_OK;

	if (!*made)
		status = make_ball(programs, kind, made, err);
	*program = *made;
	return status;
}

enum rb_status rb_programs_surface(struct rb_programs *programs, enum rb_pattern pattern,
                                   bool infinite, bool glossy, struct rb_error *err)
{
	struct rb_surface_program *program = &programs->surface[pattern][infinite][glossy];
	char defines[DEFINES_SIZE], lights[RB_LIGHTS_DEFINES_SIZE];

	if (program->name)
		return RB_OK;
	rb_lights_define(programs->lights, true, lights, sizeof lights);
	snprintf(defines, sizeof defines,
	         "#define PATTERN %d\n#define FINE\n#define TEXEL %.9f\n%s%s%s%s", (int)pattern,
	         1.0 / RB_SHADOW_SIDE, glossy ? "#define GLOSS\n" : "",
	         infinite ? "#define HAZE\n" : "", programs->grid ? "#define GRID\n" : "", lights);
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

enum rb_status rb_programs_solid(struct rb_programs *programs, enum rb_pattern pattern,
                                 GLuint *program, struct rb_error *err)
{
	char defines[DEFINES_SIZE], lights[RB_LIGHTS_DEFINES_SIZE];
	enum rb_status status = RB_OK;

	if (!programs->solid[pattern]) {
		rb_lights_define(programs->lights, true, lights, sizeof lights);
		snprintf(defines, sizeof defines,
		         "#define PATTERN %d\n#define GLOSS\n#define FINE\n#define TEXEL %.9f\n%s",
		         (int)pattern, 1.0 / RB_SHADOW_SIDE, lights);
		const struct rb_glsl_parts parts = {
			.name = "solid",
			.defines = defines,
			.vertex = {rb_shader_scene, rb_shader_solid, rb_shader_solid_vertex},
			.fragment = {rb_shader_scene, rb_shader_light, rb_shader_pattern,
		                     rb_shader_solid_fragment},
		};
		status = rb_glsl_program(&programs->solid[pattern], &parts, err);
		if (status == RB_OK)
			wire(programs->solid[pattern]);
	}
	*program = programs->solid[pattern];
	return status;
}

enum rb_status rb_programs_shadows(struct rb_programs *programs, struct rb_error *err)
{
	const char *fix = rb_canvas_depth_from_zero(programs->canvas)
	                          ? "gl_Position.z = 0.5 * (gl_Position.z + gl_Position.w);"
	                          : "";
	enum rb_status status = RB_OK;
	char defines[200];

	for (int k = 0; k < RB_DISC_SIZES && status == RB_OK; k++) {
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
		status = rb_glsl_program(&programs->disc[k], &parts, err);
	}
	snprintf(defines, sizeof defines, "#define FIX_DEPTH %s\n", fix);
	const struct rb_glsl_parts parts = {
		.name = "flat",
		.defines = defines,
		.vertex = {rb_shader_scene, rb_shader_flat_vertex},
		.fragment = {rb_shader_nothing},
	};
	const struct rb_glsl_parts solid = {
		.name = "solid's shadow",
		.defines = defines,
		.vertex = {rb_shader_solid, rb_shader_solid_shadow},
		.fragment = {rb_shader_nothing},
	};
	if (status == RB_OK)
		status = rb_glsl_program(&programs->flat, &parts, err);
	return status != RB_OK ? status : rb_glsl_program(&programs->solid_shadow, &solid, err);
}
