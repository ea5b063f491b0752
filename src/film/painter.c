/* SPDX-License-Identifier: MIT */
/*
 * Order of a picture: shadow maps, then from near to far everything opaque, the sky where nothing
 * else is, then blended rims and lines. Depths are reversed (GL_GREATER, cleared to 0), which
 * spreads the precision of floats evenly over distances.
 */
#include "film/painter.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "film/bodies.h"
#include "film/canvas.h"
#include "film/glsl.h"
#include "film/lines.h"
#include "film/shadow.h"
#include "film/solid_shapes.h"

/*
 * BAND_SAMPLES are drawn at a time, so that large pictures hear of their end: some 0.1 s. Bands are
 * whole tiles of the renderer: edges that cut through one have moved the last bit of colours.
 */
enum { BAND_SAMPLES = 1 << 24, TILE_PX = 64 };

struct rb_painter {
	const atomic_bool *cut; /* borrowed; NULL: nobody asks */
	const struct rb_model *model;
	const struct rb_camera_def *camera;
	struct rb_canvas *canvas;
	struct rb_looks looks;
	struct rb_lights lights;
	struct rb_shadows shadows;
	struct rb_bodies *bodies;
	struct rb_lines *lines; /* NULL where the camera has none */
	GLuint block, sky_program, sky_array;
	struct rb_pixmap picture;
	struct rb_painter_times times;
	struct rb_view view; /* of `picture` */
};

/* The sky's program: a triangle over the whole picture at the far depth. */
static enum rb_status make_sky(struct rb_painter *painter, struct rb_error *err)
{
	char defines[RB_LIGHTS_DEFINES_SIZE + 120], lights[RB_LIGHTS_DEFINES_SIZE];

	rb_lights_define(&painter->lights, false, lights, sizeof lights);
	snprintf(defines, sizeof defines, "#define SKY_DEPTH %s\n%s",
	         rb_canvas_depth_from_zero(painter->canvas) ? "0.0" : "-1.0", lights);
	const struct rb_glsl_parts parts = {
		.name = "sky",
		.defines = defines,
		.vertex = {rb_shader_scene, rb_shader_sky_vertex},
		.fragment = {rb_shader_scene, rb_shader_light, rb_shader_sky_fragment},
	};
	const enum rb_status status = rb_glsl_program(&painter->sky_program, &parts, err);
	if (status != RB_OK)
		return status;
	glUniformBlockBinding(painter->sky_program,
	                      glGetUniformBlockIndex(painter->sky_program, "Scene"), 0);
	glGenVertexArrays(1, &painter->sky_array);
	glGenBuffers(1, &painter->block);
	return rb_canvas_check("make a sky", err);
}

/*
 * True if multisampling is needed, which costs more than all else together: only for edges of
 * planes and polyhedra. Edges of spheres have a formula, a horizon lies in haze, lines have their
 * own.
 */
static bool needs_samples(const struct rb_model *model, const struct rb_looks *looks)
{
	int infinite = 0;

	if (rb_solids_number(model, looks) > 0)
		return true;
	for (int i = 0; i < model->body_count + model->static_count; i++) {
		if (!looks->of[i].visible)
			continue;
		if (model->shape[i].kind == RB_SHAPE_RECTANGLE)
			return true;
		infinite += model->shape[i].kind == RB_SHAPE_PLANE;
	}
	return infinite > 1;
}

/*
 * Everything that the camera needs; the order matters, since the canvas makes the context current.
 */
static enum rb_status make(struct rb_painter *painter, struct rb_error *err)
{
	const struct rb_camera_def *camera = painter->camera;
	const int width = camera->size_px[0], height = camera->size_px[1];

	enum rb_status status = rb_pixmap_init(&painter->picture, width, height, err);
	if (status == RB_OK)
		status = rb_looks_make(&painter->looks, painter->model, err);
	if (status == RB_OK && camera->framed)
		rb_looks_show_motion(&painter->looks, painter->model, camera);
	if (status == RB_OK)
		status = rb_canvas_create(
			&painter->canvas, width, height,
			!camera->wireframe && needs_samples(painter->model, &painter->looks)
				? camera->samples
				: 0,
			err);
	if (status != RB_OK)
		return status;
	rb_lights_make(&painter->lights, painter->model, camera);
	status = make_sky(painter, err);
	if (status == RB_OK && !camera->wireframe)
		status = rb_shadows_make(&painter->shadows, &painter->lights, err);
	const struct rb_bodies_setup setup = {.model = painter->model,
	                                      .looks = &painter->looks,
	                                      .camera = camera,
	                                      .lights = &painter->lights,
	                                      .canvas = painter->canvas,
	                                      .soft = camera->samples > 1 &&
	                                              rb_canvas_samples(painter->canvas) == 0};
	if (status == RB_OK)
		status = rb_bodies_create(&painter->bodies, &setup, err);
	if (status == RB_OK && rb_lines_needed(&setup))
		status = rb_lines_create(&painter->lines, &setup, err);
	return status;
}

enum rb_status rb_painter_create(struct rb_painter **painter_out, const struct rb_model *model,
                                 const struct rb_camera_def *camera, struct rb_error *err)
{
	*painter_out = NULL;
	struct rb_painter *painter = rb_memory_take(1, sizeof *painter);
	if (!painter)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	painter->model = model;
	painter->camera = camera;
	const enum rb_status status = make(painter, err);
	if (status != RB_OK) {
		rb_painter_destroy(painter);
		return status;
	}
	*painter_out = painter;
	return RB_OK;
}

void rb_painter_destroy(struct rb_painter *painter)
{
	if (!painter)
		return;
	rb_lines_destroy(painter->lines);
	rb_bodies_destroy(painter->bodies);
	rb_canvas_destroy(painter->canvas);
	rb_looks_release(&painter->looks);
	rb_pixmap_release(&painter->picture);
	rb_memory_free(painter);
}

/* Clears to the horizon's colour and depth 0, the farthest. */
static void clear(const struct rb_painter *painter)
{
	const double *c = painter->lights.horizon;

	glClearColor((float)c[0], (float)c[1], (float)c[2], 1);
	glClearDepth(0);
	glDepthMask(GL_TRUE);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	glDepthFunc(GL_GREATER);
}

/* Draws the sky where the depth is still the farthest. */
static void draw_sky(const struct rb_painter *painter)
{
	glDepthFunc(GL_GEQUAL);
	glUseProgram(painter->sky_program);
	glBindVertexArray(painter->sky_array);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glDepthFunc(GL_GREATER);
}

/* Uploads the uniform block. */
static void tell(const struct rb_painter *painter, const struct rb_shader_block *block)
{
	glBindBuffer(GL_UNIFORM_BUFFER, painter->block);
	glBufferData(GL_UNIFORM_BUFFER, sizeof *block, block, GL_STREAM_DRAW);
	glBindBufferBase(GL_UNIFORM_BUFFER, 0, painter->block);
}

/* All of a picture after the shadows, where the scissors let it through. */
static enum rb_status draw_band(struct rb_painter *painter, const struct rb_frame *frame,
                                const struct rb_view *view, const struct rb_trails *trails,
                                struct rb_error *err)
{
	const bool wireframe = painter->camera->wireframe;

	glDisable(GL_BLEND);
	clear(painter);
	if (!wireframe)
		rb_bodies_draw(painter->bodies);
	if (!painter->lights.plain)
		draw_sky(painter);
	glEnable(GL_BLEND);
	glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
	glDepthMask(GL_FALSE);
	if (wireframe)
		rb_bodies_draw(painter->bodies);
	else
		rb_bodies_soften(painter->bodies);
	return painter->lines ? rb_lines_draw(painter->lines, frame, view, trails, err) : RB_OK;
}

/* The canvas from its lower to its upper edge, whole if it is not large. */
static enum rb_status draw_bands(struct rb_painter *painter, const struct rb_frame *frame,
                                 const struct rb_view *view, const struct rb_trails *trails,
                                 struct rb_error *err)
{
	const int width = painter->picture.width, height = painter->picture.height;
	const int samples = rb_canvas_samples(painter->canvas);
	const int rows = BAND_SAMPLES / width / (samples > 1 ? samples : 1);
	const int band = (rows / TILE_PX + 1) * TILE_PX;
	enum rb_status status = RB_OK;

	if (band >= height)
		return draw_band(painter, frame, view, trails, err);
	glEnable(GL_SCISSOR_TEST);
	for (int row = 0; row < height && !status; row += band) {
		if (painter->cut && atomic_load(painter->cut)) {
			status = RB_FAIL(err, RB_ERR_INTERRUPT, "a picture was given up");
			break;
		}
		glScissor(0, row, width, band < height - row ? band : height - row);
		status = draw_band(painter, frame, view, trails, err);
		glFinish();
	}
	glDisable(GL_SCISSOR_TEST);
	return status;
}

/* One picture into the canvas. */
static enum rb_status draw(struct rb_painter *painter, const struct rb_frame *frame,
                           const struct rb_view *view, const struct rb_trails *trails,
                           struct rb_error *err)
{
	struct rb_shader_block block;

	rb_lights_tell(&painter->lights, view, rb_canvas_depth_from_zero(painter->canvas), &block);
	const enum rb_status status = rb_bodies_see(painter->bodies, frame, view, err);
	if (status != RB_OK)
		return status;
	glDisable(GL_BLEND);
	tell(painter, &block);
	if (!painter->camera->wireframe) {
		rb_shadows_draw(&painter->shadows, &painter->lights, view, painter->bodies, &block);
		tell(painter, &block);
	}
	rb_canvas_begin(painter->canvas);
	return draw_bands(painter, frame, view, trails, err);
}

void rb_painter_heed(struct rb_painter *painter, const atomic_bool *cut)
{
	painter->cut = cut;
}

enum rb_status rb_painter_draw(struct rb_painter *painter, const struct rb_frame *frame,
                               const struct rb_frame_shot *shot, const struct rb_trails *trails,
                               struct rb_pixmap *picture, struct rb_error *err)
{
	struct rb_view view;

	*picture = (struct rb_pixmap){0};
	const uint64_t start = rb_clock_now_ns();
	enum rb_status status = rb_view_make(&view, painter->model, painter->camera, frame, shot,
	                                     err);
	if (status == RB_OK)
		status = rb_canvas_enter(painter->canvas, err);
	if (status == RB_OK)
		status = draw(painter, frame, &view, trails, err);
	if (status != RB_OK)
		return status;
	glFinish();
	const uint64_t drawn = rb_clock_now_ns();
	status = rb_canvas_read(painter->canvas, &painter->picture, err);
	if (status != RB_OK)
		return status;
	painter->view = view;
	painter->times.draw_ns += drawn - start;
	painter->times.read_ns += rb_clock_now_ns() - drawn;
	*picture = painter->picture;
	return RB_OK;
}

const struct rb_view *rb_painter_view(const struct rb_painter *painter)
{
	return &painter->view;
}

struct rb_painter_times rb_painter_times(const struct rb_painter *painter)
{
	return painter->times;
}

const char *rb_painter_renderer(const struct rb_painter *painter)
{
	return rb_canvas_renderer(painter->canvas);
}
