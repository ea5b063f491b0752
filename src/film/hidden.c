/* SPDX-License-Identifier: MIT */
/*
 * Conservative occlusion culling of spheres by spheres, in software: for each pixel the distance up
 * to which it is certainly covered. Spheres come from near to far; one whose pixels are all covered
 * before its nearest point is hidden. Discs are shrunk where they cover and grown where they are
 * tested, so that nothing visible is dropped.
 */
#include "film/hidden.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/vec3.h"

/*
 * Width of soft edges, px: the outermost pixels of a sphere do not cover, and reach out when
 * tested.
 */
static const double EDGE_PX = 0.8;

enum rb_status rb_hidden_init(struct rb_hidden *hidden, int width, int height, struct rb_error *err)
{
	*hidden = (struct rb_hidden){.across = width, .down = height};
	hidden->reach = rb_memory_take((size_t)hidden->across * (size_t)hidden->down,
	                               sizeof *hidden->reach);
	if (!hidden->reach)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	return RB_OK;
}

void rb_hidden_release(struct rb_hidden *hidden)
{
	rb_memory_free(hidden->reach);
	*hidden = (struct rb_hidden){0};
}

void rb_hidden_clear(struct rb_hidden *hidden)
{
	for (int k = 0; k < hidden->across * hidden->down; k++)
		hidden->reach[k] = INFINITY;
}

/* Rows (or columns) that a circle touches, within the picture. */
static void rows_of(int range[2], double at, double radius, int count)
{
	range[0] = (int)fmax(0, floor(at - radius));
	range[1] = (int)fmin(count - 1, floor(at + radius));
}

/* True if all pixels that the circle touches are covered before `nearest`. */
static bool is_behind(const struct rb_hidden *hidden, const double at[2], double radius,
                      float nearest)
{
	int rows[2], columns[2];

	rows_of(rows, at[1], radius, hidden->down);
	for (int j = rows[0]; j <= rows[1]; j++) {
		const double v = fmax(0, fmax(j - at[1], at[1] - (j + 1)));
		const float *reach = hidden->reach + (size_t)j * (size_t)hidden->across;
		rows_of(columns, at[0], sqrt(fmax(0, radius * radius - v * v)), hidden->across);
		for (int i = columns[0]; i <= columns[1]; i++)
			if (!(reach[i] < nearest))
				return false;
	}
	return true;
}

/* Pixels wholly within the circle are covered from `distance` on. */
static void cover(struct rb_hidden *hidden, const double at[2], double radius, float distance)
{
	int rows[2];

	if (!(radius > 0))
		return;
	rows_of(rows, at[1], radius, hidden->down);
	for (int j = rows[0]; j <= rows[1]; j++) {
		const double v = fmax(fabs(j - at[1]), fabs(j + 1 - at[1]));
		const double half = radius * radius - v * v;
		if (!(half > 0))
			continue;
		float *reach = hidden->reach + (size_t)j * (size_t)hidden->across;
		const int from = (int)fmax(0, ceil(at[0] - sqrt(half)));
		const int to = (int)fmin(hidden->across, floor(at[0] + sqrt(half)));
		for (int i = from; i < to; i++)
			if (distance < reach[i])
				reach[i] = distance;
	}
}

bool rb_hidden_add(struct rb_hidden *hidden, const struct rb_view *view, rb_vec3 centre,
                   double radius)
{
	const double distance = rb_view_distance(view, centre);
	const double lean = rb_view_lean(view, centre, radius);
	const double pixel_x = (view->right_slope - view->left_slope) / view->width;
	const double pixel_y = rb_view_pixel_size(view);
	double at[2];

	if (view->parallel) {
		rb_view_pixel(view, centre, at);
		if (is_behind(hidden, at, radius / fmin(pixel_x, pixel_y) + EDGE_PX,
		              (float)(distance - radius)))
			return true;
		cover(hidden, at, radius / fmax(pixel_x, pixel_y) - EDGE_PX, (float)distance);
		return false;
	}
	/*
	 * The outline is an ellipse: at an angle t from the axis it reaches sin(a) / (cos(t) cos(t
	 * + a)) outwards, a its angular radius, and nowhere less than sin(a) from the centre's
	 * place.
	 */
	const double cosine = -centre.z / distance;
	const double sine = sqrt(fmax(0, 1 - cosine * cosine));
	const double outwards = cosine * sqrt(fmax(0, 1 - lean * lean)) - sine * lean;
	/* towards the picture's far corners and very near, the bounds are poor: always drawn */
	if (!(outwards > 0.2) || !(lean < 0.9))
		return false;
	rb_view_pixel(view, centre, at);
	const double most = lean / (cosine * outwards * fmin(pixel_x, pixel_y)) + EDGE_PX;
	if (is_behind(hidden, at, most, (float)(distance - radius)))
		return true;
	cover(hidden, at, lean / fmax(pixel_x, pixel_y) - EDGE_PX, (float)distance);
	return false;
}
