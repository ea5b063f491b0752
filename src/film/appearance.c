/* SPDX-License-Identifier: MIT */
/*
 * Colours are in linear light (model/colour); shaders and blending work in it and the framebuffer
 * encodes sRGB again.
 */
#include "film/appearance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "film/png.h"
#include "flow/joint_view.h"
#include "model/colour.h"
#include "model/joint_type.h"

/*
 * Second colour of a plane's pattern as a share of the first, in steps of perceived lightness
 * (squared for linear light).
 */
static const double PLANE_SHADE = 0.62;
static const double SOLID_GLOSS = 55; /* exponent of Blinn and Phong: like painted plastic */

double rb_look_linear(double srgb)
{
	return rb_colour_linear(srgb);
}

/* Order of doubles for qsort. */
static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* The nearest of 1, 2 and 5 times a power of ten. */
static double round_length(double wanted_m)
{
	const double ten = pow(10, floor(log10(wanted_m)));
	const double part = wanted_m / ten;

	return ten * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

/*
 * Sets size_m, the median diameter of moving solids (else of static ones, else a fifth of a
 * rectangle; 1 m without any), and cell_m, the cell of patterns: twice that, rounded to 1, 2 or 5
 * times a power of ten.
 */
static enum rb_status measure(struct rb_looks *looks, const struct rb_model *model,
                              struct rb_error *err)
{
	const int total = model->body_count + model->static_count;
	double *sizes = rb_memory_take((size_t)total, sizeof *sizes);

	if (!sizes)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	int count = 0;
	for (int part = 0; part < 2 && count == 0; part++)
		for (int i = part ? model->body_count : 0; i < (part ? total : model->body_count);
		     i++)
			if (rb_model_reach(model, i) > 0)
				sizes[count++] = 2 * rb_model_reach(model, i);
	for (int i = 0; i < total && count == 0; i++)
		if (model->shape[i].kind == RB_SHAPE_RECTANGLE)
			sizes[count++] = 0.2 *
			                 fmin(model->shape[i].size[0], model->shape[i].size[1]);
	if (count > 0)
		qsort(sizes, (size_t)count, sizeof *sizes, compare);
	looks->size_m = count > 0 ? sizes[count / 2] : 1;
	rb_memory_free(sizes);

	looks->cell_m = round_length(2 * looks->size_m);
	return RB_OK;
}

/* The scene's file of that name; NULL if it has none. */
static const struct rb_source_file *file_of(const struct rb_scene *scene, const char *name)
{
	for (int k = 0; k < scene->file_count; k++)
		if (strcmp(scene->files[k].name, name) == 0)
			return &scene->files[k];
	return NULL;
}

/* Finds or decodes the picture of a texture; `*image` is its index. Pictures are shared by name. */
static enum rb_status load(struct rb_looks *looks, int *image, const char *name,
                           const struct rb_model *model, int id, struct rb_error *err)
{
	const struct rb_scene *scene = model->scene;
	const struct rb_source_file *file = file_of(scene, name);
	struct rb_error why;
	char text[64];

	for (*image = 0; *image < looks->image_count; ++*image)
		if (strcmp(looks->names[*image], name) == 0)
			return RB_OK;
	const size_t count = (size_t)looks->image_count;
	struct rb_pixmap *images = rb_memory_grow(looks->images, count, count + 1,
	                                          sizeof *looks->images);
	if (images)
		looks->images = images;
	const char **names = rb_memory_grow(looks->names, count, count + 1, sizeof *looks->names);
	if (names)
		looks->names = names;
	if (!images || !names)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load texture '%s': out of memory", name);
	if (!file)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "%s:%d: body '%s': no texture '%s' came with the scene", scene->file,
		               scene->bodies[id].line, rb_scene_body_label(scene, id, text), name);
	const enum rb_status status = rb_png_decode(&looks->images[count], name, file->text,
	                                            file->size_bytes, &why);
	if (status == RB_ERR_SCENE)
		return RB_FAIL(err, status, "%s:%d: body '%s': %s", scene->file,
		               scene->bodies[id].line, rb_scene_body_label(scene, id, text),
		               why.text);
	if (status != RB_OK)
		return RB_FAIL(err, status, "%s", why.text);
	looks->names[count] = name;
	looks->image_count++;
	return RB_OK;
}

/* Colour and gloss of a body. */
static void colour(struct rb_look *look, const struct rb_scene *scene,
                   const struct rb_body_def *body)
{
	const struct rb_material_def *const material = &scene->materials[body->material];
	const bool solid = body->shape.kind != RB_SHAPE_PLANE &&
	                   body->shape.kind != RB_SHAPE_RECTANGLE;
	double linear[3];

	rb_colour_of(scene, body, linear);
	for (int k = 0; k < 3; k++) {
		look->colour[k] = (float)linear[k];
		look->other[k] = (float)(linear[k] * PLANE_SHADE * PLANE_SHADE);
	}
	look->gloss = (float)(isnan(material->shininess) ? (solid ? SOLID_GLOSS : 0)
	                                                 : material->shininess);
}

/* Pattern or picture of the body, else of its material. */
static enum rb_status decorate(struct rb_looks *looks, struct rb_look *look,
                               const struct rb_model *model, int id, struct rb_error *err)
{
	static const struct {
		const char *name;
		enum rb_pattern pattern;
	} patterns[] = {{"none", RB_PATTERN_PLAIN},
	                {"checker", RB_PATTERN_CHECKER},
	                {"stripes", RB_PATTERN_STRIPES},
	                {"beachball", RB_PATTERN_BEACHBALL}};
	const struct rb_body_def *body = &model->scene->bodies[id];
	const struct rb_material_def *material = &model->scene->materials[body->material];
	const char *texture = rb_colour_texture(model->scene, body);

	look->image = -1;
	look->plain = !texture;
	if (!texture)
		return RB_OK;
	for (size_t k = 0; k < sizeof patterns / sizeof patterns[0]; k++)
		if (strcmp(texture, patterns[k].name) == 0) {
			look->pattern = patterns[k].pattern;
			return RB_OK;
		}
	/* a palette colour would tint the picture */
	if (isnan(body->color[0]) && isnan(material->color[0]))
		for (int k = 0; k < 3; k++)
			look->colour[k] = 1;
	look->pattern = RB_PATTERN_IMAGE;
	return load(looks, &look->image, texture, model, id, err);
}

/* A joint is plain and shines like metal; a rope does not. */
static void paint_joint(struct rb_look *look, const struct rb_scene *scene, int joint)
{
	double color[3];

	*look = (struct rb_look){.image = -1, .visible = scene->joints[joint].visible};
	if (rb_joint_type(scene->joints[joint].kind)->form != RB_JOINT_CORD)
		look->gloss = (float)SOLID_GLOSS;
	rb_joint_color(scene, joint, color);
	for (int k = 0; k < 3; k++)
		look->colour[k] = look->other[k] = (float)(0.9 * rb_look_linear(color[k]));
}

enum rb_status rb_looks_make(struct rb_looks *looks, const struct rb_model *model,
                             struct rb_error *err)
{
	const struct rb_scene *scene = model->scene;

	*looks = (struct rb_looks){0};
	looks->of = rb_memory_take((size_t)scene->body_count + (size_t)scene->joint_count,
	                           sizeof *looks->of);
	if (!looks->of)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	enum rb_status status = measure(looks, model, err);
	for (int id = 0; id < scene->body_count && status == RB_OK; id++) {
		const struct rb_body_def *body = &scene->bodies[id];
		RB_ASSERT(body->material >= 0 && body->material < scene->material_count);
		struct rb_look *look = &looks->of[model->index_of[id]];
		look->visible = body->visible;
		colour(look, scene, body);
		status = decorate(looks, look, model, id, err);
	}
	for (int k = 0; k < scene->joint_count; k++)
		paint_joint(&looks->of[scene->body_count + k], scene, k);
	if (status != RB_OK)
		rb_looks_release(looks);
	return status;
}

/* m: height of the camera's picture where it looks; 0: it depends on the time. */
static double picture_height(const struct rb_camera_def *camera)
{
	if (camera->orthographic && !camera->has_frustum)
		return isfinite(camera->height) ? camera->height : 0;
	if (camera->position.source != RB_CAMERA_FIXED || camera->look_at.source != RB_CAMERA_FIXED)
		return 0;
	const double distance = rb_vec3_length(
		rb_vec3_sub(camera->look_at.value, camera->position.value));
	const double *const f = camera->frustum;
	if (camera->has_frustum)
		return (f[3] - f[2]) * (camera->orthographic ? 1 : distance / f[4]);
	return 2 * distance * tan(0.5 * camera->fov);
}

void rb_looks_show_motion(struct rb_looks *looks, const struct rb_model *model,
                          const struct rb_camera_def *camera)
{
	/* this many squares from edge to edge of the picture at most */
	static const double squares_most = 8;

	looks->cell_m = fmax(
		looks->cell_m,
		round_length(fmax(2 * looks->size_m, picture_height(camera) / squares_most)));
	for (int i = model->body_count; i < model->body_count + model->static_count; i++)
		if (looks->of[i].plain && (model->shape[i].kind == RB_SHAPE_PLANE ||
		                           model->shape[i].kind == RB_SHAPE_RECTANGLE))
			looks->of[i].pattern = RB_PATTERN_CHECKER;
}

void rb_looks_release(struct rb_looks *looks)
{
	for (int k = 0; k < looks->image_count; k++)
		rb_pixmap_release(&looks->images[k]);
	rb_memory_free(looks->images);
	rb_memory_free(looks->names);
	rb_memory_free(looks->of);
	*looks = (struct rb_looks){0};
}
