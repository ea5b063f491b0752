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

/* Usual diagrams, in shares of the picture: size, gap between them, distance from its edges. */
static const double usual_size[2] = {0.3, 0.25}, gap_part = 0.0125, edge_part[2] = {0.014, 0.0225};

/* Letters, as a share of the usual ones; half the thickness of a curve and of a dot, px at 720. */
static const double letters_part = 0.7, line_px = 1.1, dot_px = 4, usual_height_px = 720;
static const char widest_number[] = "-0.0000";
static const uint8_t ink[3] = {255, 214, 64};
static const double shade = 0.4; /* share of the background's light that is left */

struct rb_curves {
	const struct rb_model *model;
	const struct rb_camera_def *camera;
	struct rb_overlay *overlay; /* owned */
	char span_text[64];         /* the time from end to end */
	struct rb_film_span span;
	struct rb_quantity_turn turn[RB_CAMERA_PLOTS_MAX];
	uint64_t seen, stride;
	int count;
	double magnitude
		[RB_CAMERA_PLOTS_MAX]; /* that rounding is relative to, the largest so far */
	double time_s[POINTS_MAX], value[RB_CAMERA_PLOTS_MAX][POINTS_MAX];
};

/* A diagram's place in the picture, px, and its ranges. */
struct axes {
	int left, top, width, height;
	double from, to, low, high;
};

enum rb_status rb_curves_create(struct rb_curves **curves, const struct rb_model *model,
                                const struct rb_camera_def *camera, const char *span_text,
                                struct rb_error *err)
{
	struct rb_curves *const c = *curves = rb_memory_take(1, sizeof *c);

	if (!c)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare diagrams: out of memory");
	c->model = model;
	c->camera = camera;
	c->span = rb_film_span_of(camera, model->duration_s);
	c->stride = 1;
	snprintf(c->span_text, sizeof c->span_text, "%s", span_text);
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

static double magnitude_at(const struct rb_curves *curves, int p, const struct rb_frame *frame)
{
	const struct rb_plot_def *const plot = &curves->camera->plots[p];
	const struct rb_model *const model = curves->model;

	switch (plot->of) {
	case RB_PLOT_PROBE:
		return 0;
	case RB_PLOT_WORLD:
		return rb_world_part_magnitude(plot->part, model, frame);
	case RB_PLOT_BODY:
		return rb_body_part_magnitude(plot->part, model, frame,
		                              model->index_of[plot->subject]);
	case RB_PLOT_JOINT:
		return rb_joint_part_magnitude(plot->part, model, frame, plot->subject);
	}
	return 0;
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
	for (int p = 0; p < curves->camera->plot_count; p++) {
		now[p] = value_at(curves, p, frame);
		if (!isnan(now[p]))
			curves->magnitude[p] = fmax(curves->magnitude[p],
			                            magnitude_at(curves, p, frame));
	}
	if (frame->time_s < curves->span.from_s || frame->time_s > curves->span.to_s)
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

/* The room that a text takes in a diagram, px, with some around it. */
static int width_of(const struct rb_curves *curves, const char *text)
{
	const struct rb_overlay_size size = rb_overlay_size_of(curves->overlay, text);

	return size.width + size.height / 2;
}

/* Writes a text at an edge of a diagram, at the left one into this room, px. */
static void write_right(struct rb_curves *curves, const struct axes *box, int y, const char *text,
                        struct rb_pixmap *picture)
{
	const int width = width_of(curves, text);
	const int margin = (width - rb_overlay_size_of(curves->overlay, text).width) / 2;

	rb_overlay_put(curves->overlay, picture, box->left + box->width - width + margin, y, width,
	               text);
}

static void write_left(struct rb_curves *curves, const struct axes *box, int y, int room,
                       const char *text, struct rb_pixmap *picture)
{
	const int margin = width_of(curves, "") / 2;

	rb_overlay_put(curves->overlay, picture, box->left + margin, y, room - 2 * margin, text);
}

/* Both ends of an axis, with as many digits as tell them apart. */
static void print_ends(char low_text[32], char high_text[32], double low, double high)
{
	enum { FEWEST = 4, MOST = 12 };

	for (int digits = FEWEST; digits <= MOST; digits++) {
		snprintf(low_text, 32, "%.*g", digits, low);
		snprintf(high_text, 32, "%.*g", digits, high);
		if (strcmp(low_text, high_text) != 0)
			break;
	}
}

/* Writes both ends of the axis, the upper one below the name if that leaves it no room. */
static void write_ends(struct rb_curves *curves, const struct axes *box, const struct axes *axes,
                       int name_width, struct rb_pixmap *picture)
{
	const int line = rb_overlay_size_of(curves->overlay, "0").height;
	const int room = box->width - width_of(curves, widest_number);
	char low[32], high[32];

	print_ends(low, high, axes->low, axes->high);
	const bool beside = name_width <= room && name_width + width_of(curves, high) <= box->width;
	write_right(curves, box, beside ? box->top : axes->top, high, picture);
	write_right(curves, box, box->top + box->height - line, low, picture);
	if (axes->top > box->top && width_of(curves, curves->span_text) <= room &&
	    width_of(curves, curves->span_text) + width_of(curves, low) <= box->width)
		write_left(curves, box, box->top + box->height - line, room, curves->span_text,
		           picture);
}

/*
 * Name and unit, the time, if it has room, and the values: both ends, or where the curve is flat
 * that at its right end. Room is left for any number, so that nothing moves as numbers change.
 */
static void write_axes(struct rb_curves *curves, int p, const struct axes *box,
                       const struct axes *axes, bool flat, struct rb_pixmap *picture)
{
	const struct rb_plot_def *const plot = &curves->camera->plots[p];
	const char *const units = units_of(curves, plot);
	const int line = rb_overlay_size_of(curves->overlay, "0").height;
	char text[120];

	snprintf(text, sizeof text, units && *units ? "%.60s (%.31s)" : "%.60s", plot->name, units);
	write_left(curves, box, box->top, box->width, text, picture);
	if (!isfinite(axes->low) || !isfinite(axes->high))
		return;
	if (!flat) {
		write_ends(curves, box, axes, width_of(curves, text), picture);
		return;
	}
	snprintf(text, sizeof text, "%.4g", 0.5 * (axes->low + axes->high));
	write_right(curves, box, axes->top + axes->height / 2 - line, text, picture);
	if (axes->top > box->top &&
	    width_of(curves, curves->span_text) + width_of(curves, widest_number) <= box->width)
		write_left(curves, box, box->top + box->height - line, box->width,
		           curves->span_text, picture);
}

/* The range of a diagram's values; true: they are one up to rounding, which is in its middle. */
static bool find_range(const struct rb_curves *curves, int p, struct axes *axes)
{
	double low = (double)INFINITY, high = -(double)INFINITY;

	for (int i = 0; i < curves->count; i++) {
		low = fmin(low, curves->value[p][i]);
		high = fmax(high, curves->value[p][i]);
	}
	const bool flat = low <= high && isfinite(low) && isfinite(high) &&
	                  rb_quantity_is_flat(low, high, curves->magnitude[p]);
	axes->low = low;
	axes->high = high;
	if (!flat)
		return false;
	const bool is_zero = rb_quantity_is_flat(fmin(low, 0), fmax(high, 0), curves->magnitude[p]);
	const double value = is_zero ? 0 : low + 0.5 * (high - low);
	const double half = fmax(fabs(value), curves->magnitude[p]);
	axes->low = value - (half > 0 ? half : 1);
	axes->high = value + (half > 0 ? half : 1);
	return true;
}

static void draw_one(struct rb_curves *curves, int p, const struct axes *box,
                     struct rb_pixmap *picture)
{
	const double scale = fmax(0.5, picture->height / usual_height_px);
	const int line = rb_overlay_size_of(curves->overlay, "0").height;
	/* the curve between the lines of text, if they leave it the height of one */
	const int above = box->height >= 3 * line ? line : 0;
	struct axes axes = {.left = box->left,
	                    .top = box->top + above,
	                    .width = box->width,
	                    .height = box->height - 2 * above,
	                    .from = curves->span.from_s,
	                    .to = curves->span.to_s};
	const bool flat = find_range(curves, p, &axes);

	darken(picture, box);
	if (curves->count > 0 && isfinite(axes.low) && isfinite(axes.high) && axes.height > 0 &&
	    axes.width > 0 && axes.to > axes.from) {
		const int last = curves->count - 1;
		draw_curve(curves, p, &axes, line_px * scale, picture);
		if (isfinite(curves->value[p][last]))
			draw_dot(&axes, curves->time_s[last], curves->value[p][last],
			         dot_px * scale, picture);
	}
	write_axes(curves, p, box, &axes, flat, picture);
}

/*
 * Where diagrams stand in a picture: at their places, the others one above the other at the right,
 * of equal heights unless they have their own, and in a further column where they do not fit.
 */
static void arrange(const struct rb_curves *curves, int upper_px, int lower_px,
                    const struct rb_pixmap *picture, struct axes box[RB_CAMERA_PLOTS_MAX])
{
	const int count = curves->camera->plot_count;
	const double width = picture->width, height = picture->height, gap = gap_part * height;
	const double top = fmax(upper_px, edge_part[1] * height);
	const double bottom = height - fmax(lower_px, edge_part[1] * height);
	double right = (1 - edge_part[0]) * width, low = bottom, column = 0;
	int stacked = 0;

	for (int p = 0; p < count; p++)
		stacked += isnan(curves->camera->plots[p].at[0]);
	const double share = (bottom - top - gap * (stacked - 1)) / fmax(stacked, 1);
	for (int p = 0; p < count; p++) {
		const struct rb_plot_def *const plot = &curves->camera->plots[p];
		const bool usual = isnan(plot->size[0]), placed = !isnan(plot->at[0]);
		const double wide = width * (usual ? usual_size[0] : plot->size[0]);
		const double most = placed ? usual_size[1] * height
		                           : fmin(usual_size[1] * height, fmax(share, 1));
		const double high = usual ? most : height * plot->size[1];
		double left = plot->at[0] * (width - wide),
		       upper = (1 - plot->at[1]) * (height - high);

		if (!placed && low < bottom && low - high < top - 0.5) {
			right -= column + gap;
			low = bottom;
			column = 0;
		}
		if (!placed) {
			left = fmax(right - wide, 0);
			upper = fmax(low - high, 0);
			low -= high + gap;
			column = fmax(column, wide);
		}
		box[p] = (struct axes){.left = (int)lrint(left), .top = (int)lrint(upper)};
		box[p].width = (int)lrint(left + wide) - box[p].left;
		box[p].height = (int)lrint(upper + high) - box[p].top;
	}
}

void rb_curves_draw(struct rb_curves *curves, int upper_px, int lower_px, struct rb_pixmap *picture)
{
	struct axes box[RB_CAMERA_PLOTS_MAX];

	arrange(curves, upper_px, lower_px, picture, box);
	for (int p = 0; p < curves->camera->plot_count; p++)
		draw_one(curves, p, &box[p], picture);
}
