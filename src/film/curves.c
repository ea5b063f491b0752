/* SPDX-License-Identifier: MIT */
/*
 * The time axis is that of the whole film, the other reaches from the smallest to the largest value
 * so far: a run that is filmed while it goes on, and its recording, give the same pictures.
 */
#include "film/curves.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/quantity.h"
#include "flow/schedule.h"

enum { POINTS_MAX = 4096 }; /* of a curve; when full, every second one is dropped */

/* Letters, as a share of the usual ones; half the thickness of a curve and of a dot, px at 720. */
static const double letters_part = 0.7, line_px = 1.1, dot_px = 4, usual_height_px = 720;
static const uint8_t ink[3] = {255, 214, 64};
static const double shade = 0.4; /* share of the background's light that is left */

struct rb_curves {
	const struct rb_model *model;
	const struct rb_camera_def *camera;
	struct rb_overlay *overlay; /* owned */
	double from_s, to_s;
	struct rb_quantity_turn turn[RB_CAMERA_PLOTS_MAX];
	uint64_t seen, stride;
	int count;
	double time_s[POINTS_MAX], value[RB_CAMERA_PLOTS_MAX][POINTS_MAX];
};

/* A diagram's place in the picture, px, and its ranges. */
struct axes {
	int left, top, width, height;
	double from, to, low, high;
};

enum rb_status rb_curves_create(struct rb_curves **curves, const struct rb_model *model,
                                const struct rb_camera_def *camera, struct rb_error *err)
{
	struct rb_curves *const c = *curves = rb_memory_take(1, sizeof *c);
	const struct rb_schedule schedule = rb_schedule_of(camera, model->frame_rate,
	                                                   model->duration_s);

	if (!c)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare diagrams: out of memory");
	c->model = model;
	c->camera = camera;
	c->from_s = schedule.from_s;
	c->to_s = schedule.to_s;
	c->stride = 1;
	const enum rb_status status = rb_overlay_create(
		&c->overlay, (int)ceil(letters_part * camera->size_px[0]),
		(int)ceil(letters_part * camera->size_px[1]), err);
	if (status) {
		rb_memory_free(c);
		*curves = NULL;
	}
	return status;
}

void rb_curves_destroy(struct rb_curves *curves)
{
	if (!curves)
		return;
	rb_overlay_destroy(curves->overlay);
	rb_memory_free(curves);
}

/* The value of a quantity at a frame; NAN: the frame does not have it. */
static double value_at(struct rb_curves *curves, int p, const struct rb_frame *frame)
{
	const struct rb_plot_def *const plot = &curves->camera->plots[p];
	double value = (double)NAN;
	bool has = true;
	int body;

	switch (plot->of) {
	case RB_PLOT_PROBE:
		return plot->subject < frame->probe_count ? frame->probes[plot->subject]
		                                          : (double)NAN;
	case RB_PLOT_WORLD:
		return rb_world_part_value(plot->part, frame);
	case RB_PLOT_BODY:
		body = curves->model->index_of[plot->subject];
		has = body < frame->body_count &&
		      rb_body_part_value(plot->part, frame, body, &curves->turn[p], &value);
		break;
	case RB_PLOT_JOINT:
		has = rb_joint_part_value(plot->part, frame, plot->subject, &value);
		break;
	}
	return has ? value : (double)NAN;
}

static const char *units_of(const struct rb_curves *curves, const struct rb_plot_def *plot)
{
	const struct rb_scene *const scene = curves->model->scene;

	switch (plot->of) {
	case RB_PLOT_PROBE:
		return scene->probes[plot->subject].units;
	case RB_PLOT_WORLD:
		return rb_world_part_units(plot->part);
	case RB_PLOT_BODY:
		return rb_body_part_units(plot->part);
	case RB_PLOT_JOINT:
		return rb_joint_part_units(plot->part, scene->joints[plot->subject].kind);
	}
	return "";
}

static void thin_out(struct rb_curves *curves)
{
	const int left = (curves->count + 1) / 2;

	for (int i = 1; i < left; i++) {
		curves->time_s[i] = curves->time_s[2 * i];
		for (int p = 0; p < curves->camera->plot_count; p++)
			curves->value[p][i] = curves->value[p][2 * i];
	}
	curves->count = left;
	curves->stride *= 2;
}

void rb_curves_add(struct rb_curves *curves, const struct rb_frame *frame)
{
	double now[RB_CAMERA_PLOTS_MAX];

	/* rotations are followed from frame to frame, whether these have a point or not */
	for (int p = 0; p < curves->camera->plot_count; p++)
		now[p] = value_at(curves, p, frame);
	if (frame->time_s < curves->from_s || frame->time_s > curves->to_s)
		return;
	if (curves->seen % curves->stride == 0 && curves->count == POINTS_MAX)
		thin_out(curves);
	if (curves->seen++ % curves->stride != 0)
		return;
	curves->time_s[curves->count] = frame->time_s;
	for (int p = 0; p < curves->camera->plot_count; p++)
		curves->value[p][curves->count] = now[p];
	curves->count++;
}

/* ---- drawing ---- */

static uint8_t *pixel_at(struct rb_pixmap *picture, int x, int y)
{
	return x >= 0 && y >= 0 && x < picture->width && y < picture->height
	               ? picture->rgba + 4 * ((size_t)y * (size_t)picture->width + (size_t)x)
	               : NULL;
}

static void mix_in(struct rb_pixmap *picture, int x, int y, double cover)
{
	uint8_t *const pixel = pixel_at(picture, x, y);

	for (int c = 0; pixel && c < 3; c++)
		pixel[c] = (uint8_t)lrint(pixel[c] + fmin(cover, 1) * (ink[c] - pixel[c]));
}

/* Pixel of a value, from the upper edge of the picture. */
static double row_of(const struct axes *axes, double value)
{
	return axes->top + axes->height * (axes->high - value) / (axes->high - axes->low);
}

/* Draws a curve column by column: from the highest to the lowest of its points there. */
static void draw_curve(const struct rb_curves *curves, int p, const struct axes *axes,
                       double half_px, struct rb_pixmap *picture)
{
	const double *const time = curves->time_s, *const value = curves->value[p];
	const double step = (axes->to - axes->from) / axes->width;
	int k = 0;

	for (int x = 0; x < axes->width; x++) {
		const double begin = axes->from + x * step, end = begin + step;
		double upper = (double)INFINITY, lower = -(double)INFINITY;

		while (k + 1 < curves->count && time[k + 1] < begin)
			k++;
		for (int i = k; i + 1 < curves->count && time[i] <= end; i++) {
			const double span = time[i + 1] - time[i];
			for (int side = 0; side < 2 && span > 0; side++) {
				const double t = fmin(fmax(side ? end : begin, time[i]),
				                      time[i + 1]);
				const double y = row_of(
					axes, value[i] + (t - time[i]) / span *
								 (value[i + 1] - value[i]));
				upper = fmin(upper, y);
				lower = fmax(lower, y);
			}
		}
		/* values that are no numbers leave a gap */
		if (!(upper <= lower))
			continue;
		for (int y = (int)floor(upper - half_px); y <= (int)ceil(lower + half_px); y++)
			mix_in(picture, axes->left + x, y,
			       fmax(0, fmin(y + 0.5 - upper, lower - y - 0.5) + half_px + 0.5));
	}
}

static void draw_dot(const struct axes *axes, double time_s, double value, double radius_px,
                     struct rb_pixmap *picture)
{
	const double x = axes->left + axes->width * (time_s - axes->from) / (axes->to - axes->from);
	const double y = row_of(axes, value);

	for (int py = (int)floor(y - radius_px); py <= (int)ceil(y + radius_px); py++)
		for (int px = (int)floor(x - radius_px); px <= (int)ceil(x + radius_px); px++)
			mix_in(picture, px, py,
			       fmax(0, radius_px + 0.5 - hypot(px + 0.5 - x, py + 0.5 - y)));
}

/* Darkens what is behind a diagram, for contrast on any background. */
static void darken(struct rb_pixmap *picture, const struct axes *axes)
{
	for (int y = axes->top; y < axes->top + axes->height; y++)
		for (int x = axes->left; x < axes->left + axes->width; x++) {
			uint8_t *const pixel = pixel_at(picture, x, y);
			for (int c = 0; pixel && c < 3; c++)
				pixel[c] = (uint8_t)(shade * pixel[c]);
		}
}

/* Name and unit, the largest and the smallest value. */
static void write_axes(struct rb_curves *curves, int p, const struct axes *box, double low,
                       double high, struct rb_pixmap *picture)
{
	const struct rb_plot_def *const plot = &curves->camera->plots[p];
	const char *const units = units_of(curves, plot);
	char text[120];

	snprintf(text, sizeof text, units && *units ? "%.60s (%.31s)" : "%.60s", plot->name, units);
	const struct rb_overlay_size name = rb_overlay_size_of(curves->overlay, text);
	const int margin = name.height / 4;
	rb_overlay_put(curves->overlay, picture, box->left + margin, box->top, text);
	for (int k = 0; k < 2 && isfinite(high) && isfinite(low); k++) {
		snprintf(text, sizeof text, "%.4g", k == 0 ? high : low);
		const struct rb_overlay_size size = rb_overlay_size_of(curves->overlay, text);
		const int y = k == 0 ? box->top : box->top + box->height - size.height;
		rb_overlay_put(curves->overlay, picture,
		               box->left + box->width - size.width - margin, y, text);
	}
}

static void draw_one(struct rb_curves *curves, int p, struct rb_pixmap *picture)
{
	const struct rb_plot_def *const plot = &curves->camera->plots[p];
	const double scale = fmax(0.5, picture->height / usual_height_px);
	struct axes box = {.width = (int)lrint(plot->size[0] * picture->width),
	                   .height = (int)lrint(plot->size[1] * picture->height)};
	double low = (double)INFINITY, high = -(double)INFINITY;

	for (int i = 0; i < curves->count; i++) {
		low = fmin(low, curves->value[p][i]);
		high = fmax(high, curves->value[p][i]);
	}
	box.left = (int)lrint(plot->at[0] * (picture->width - box.width));
	box.top = (int)lrint((1 - plot->at[1]) * (picture->height - box.height));
	darken(picture, &box);
	/* the curve between the lines of text */
	const int line = rb_overlay_size_of(curves->overlay, "0").height;
	struct axes axes = {box.left,       box.top + line, box.width, box.height - 2 * line,
	                    curves->from_s, curves->to_s,   low,       high};
	if (!(high > low)) {
		axes.low -= fabs(low) > 0 ? 0.5 * fabs(low) : 1;
		axes.high += fabs(high) > 0 ? 0.5 * fabs(high) : 1;
	}
	if (curves->count > 0 && isfinite(axes.low) && isfinite(axes.high) && axes.height > 0 &&
	    axes.width > 0 && axes.to > axes.from) {
		const int last = curves->count - 1;
		draw_curve(curves, p, &axes, line_px * scale, picture);
		if (isfinite(curves->value[p][last]))
			draw_dot(&axes, curves->time_s[last], curves->value[p][last],
			         dot_px * scale, picture);
	}
	write_axes(curves, p, &box, low, high, picture);
}

void rb_curves_draw(struct rb_curves *curves, struct rb_pixmap *picture)
{
	for (int p = 0; p < curves->camera->plot_count; p++)
		draw_one(curves, p, picture);
}
