/* SPDX-License-Identifier: MIT */
/*
 * Bodies without a colour take one of a palette by their material, so that materials can be told
 * apart; planes are grey, so that bodies stand out.
 */
#include "model/colour.h"

#include <math.h>

#include "base/error.h"
#include "model/shape.h"

/*
 * Eight colours that the colour-blind can tell apart (Okabe and Ito 2008), without black, warm ones
 * first.
 */
static const double palette[][3] = {
	{0.835, 0.369, 0.000}, {0.000, 0.447, 0.698}, {0.000, 0.620, 0.451}, {0.902, 0.624, 0.000},
	{0.800, 0.475, 0.655}, {0.337, 0.706, 0.914}, {0.941, 0.894, 0.259},
};
static const double plane_colour[3] = {0.80, 0.80, 0.79};
/* No real surface reflects all light. */
static const double REFLECTED = 0.9;

double rb_colour_linear(double srgb)
{
	return srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4);
}

void rb_colour_of(const struct rb_scene *scene, const struct rb_body_def *body, double linear[3])
{
	RB_ASSERT(body->material >= 0 && body->material < scene->material_count);
	const struct rb_material_def *const material = &scene->materials[body->material];
	const bool solid = body->shape.kind != RB_SHAPE_PLANE &&
	                   body->shape.kind != RB_SHAPE_RECTANGLE &&
	                   body->shape.kind != RB_SHAPE_TERRAIN;
	const size_t palette_count = sizeof palette / sizeof palette[0];
	const double *srgb = solid ? palette[(size_t)body->material % palette_count] : plane_colour;

	if (!isnan(body->color[0]))
		srgb = body->color;
	else if (!isnan(material->color[0]))
		srgb = material->color;
	for (int k = 0; k < 3; k++)
		linear[k] = REFLECTED * rb_colour_linear(srgb[k]);
}

const char *rb_colour_texture(const struct rb_scene *scene, const struct rb_body_def *body)
{
	return body->texture ? body->texture : scene->materials[body->material].texture;
}
