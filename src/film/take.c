/* SPDX-License-Identifier: MIT */
/*
 * One camera's picture: painter, trails and texts. Formats of numbers are chosen once for the whole
 * film, so that nothing jumps from picture to picture.
 */
#include "film/take.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "film/captions.h"
#include "film/curves.h"
#include "film/overlay.h"
#include "flow/schedule.h"

/* Bytes of a text; decimals of a time; significant digits of the largest energy. */
enum { TEXT_SIZE = 256, DECIMALS_MAX = 9, ENERGY_DIGITS = 4 };

/* U+2007, as wide as a digit: numbers keep their place while they grow. */
static const char figure_space[] = "\xe2\x80\x87";

/* Part of the picture's width that a bar of the scale takes at most. */
static const double bar_part = 0.2;
enum { SCALE_LINES = 2 }; /* the bar and its length */

struct rb_take {
	const struct rb_model *model;
	const struct rb_camera_def *camera;
	struct rb_painter *painter;
	struct rb_overlay *overlay;   /* NULL: nothing is to be written */
	struct rb_captions *captions; /* NULL: the camera has none */
	struct rb_curves *curves;     /* NULL: the camera has none */
	struct rb_trails trails;

	/* how times are written: chosen once, so that they look the same in all pictures */
	struct rb_unit_def time_unit;
	int time_decimals, time_digits; /* behind and before the point */
	struct rb_schedule schedule;
	char speed[64];        /* "" at true speed */
	double largest_energy; /* J, of those seen so far */
};

/* Unit and decimals of the time: enough to distinguish two pictures. */
static void choose_time_format(struct rb_take *take)
{
	/* the first of which the whole time has a tenth */
	static const struct rb_unit_def units[] = {
		{"yr", 31557600}, {"d", 86400},        {"s", 1},
		{"ms", 1e-3},     {"\xc2\xb5s", 1e-6}, {"ns", 1e-9}};
	/* a run of hours is still told in seconds, one of weeks in days, one of decades in years */
	static const double least[] = {3e8, 1e6, 0.1, 0.1e-3, 0.1e-6, 0};
	const double end = rb_film_span_of(take->camera, take->model->duration_s).to_s;
	const double step = rb_schedule_step(&take->schedule);
	int u = 0;

	while (u < 5 && end < least[u])
		u++;
	take->time_unit = take->camera->time_unit;
	if (!take->time_unit.name)
		take->time_unit = units[end > 0 ? u : 2];
	/* 0.9999: a step of 0.001, rounded, is one */
	const double decimals = ceil(-log10(step / take->time_unit.size) * 0.9999);
	take->time_decimals = (int)fmin(fmax(decimals, 0), DECIMALS_MAX);
	const double whole = end / take->time_unit.size;
	take->time_digits = whole < 10 ? 1 : 1 + (int)fmin(floor(log10(whole)), 15);
}

/* Text for slow and fast motion at a moment; none at true speed. */
static void choose_speed_text(struct rb_take *take, double time_s)
{
	const double speed = rb_schedule_speed(&take->schedule, time_s), slower = 1 / speed;
	const bool varies = take->schedule.picture_s != NULL;

	take->speed[0] = '\0';
	if (speed == 1)
		return;
	/* in a unit that was asked for, and in large ones: how much of it a second of film shows */
	if ((take->camera->time_unit.name && strcmp(take->time_unit.name, "s") != 0) ||
	    take->time_unit.size > 1)
		snprintf(take->speed, sizeof take->speed, "%.6g %s/s", speed / take->time_unit.size,
		         take->time_unit.name);
	else if (varies) /* few digits, which do not flicker */
		snprintf(take->speed, sizeof take->speed, "%.2g\xc3\x97 speed", speed);
	else if (slower > 1 && fabs(slower - nearbyint(slower)) < 1e-9 * slower && slower < 1e9)
		snprintf(take->speed, sizeof take->speed, "1/%.0f speed", slower);
	else
		snprintf(take->speed, sizeof take->speed, "%.4g\xc3\x97 speed", speed);
}

/* Diagrams, with the time of the whole film as text. */
static enum rb_status create_curves(struct rb_take *take, struct rb_error *err)
{
	const struct rb_film_span span = rb_film_span_of(take->camera, take->model->duration_s);
	const double unit = take->time_unit.size;
	char text[64];

	snprintf(text, sizeof text, "%.6g \xe2\x80\x93 %.6g %.16s", span.from_s / unit,
	         span.to_s / unit, take->time_unit.name);
	return rb_curves_create(&take->curves, take->model, take->camera, text, err);
}

bool rb_take_writes(const struct rb_camera_def *camera)
{
	return camera->overlay || camera->plot_count > 0 || rb_captions_wanted(camera);
}

enum rb_status rb_take_create(struct rb_take **take, const struct rb_model *model,
                              const struct rb_camera_def *camera, struct rb_error *err)
{
	struct rb_take *const t = *take = rb_memory_take(1, sizeof *t);

	if (!t)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare a camera: out of memory");
	t->model = model;
	t->camera = camera;
	t->schedule = rb_schedule_of(camera, model->frame_rate, model->duration_s);
	choose_time_format(t);
	enum rb_status status = rb_trails_init(&t->trails, model, camera, err);
	if (!status && rb_take_writes(camera))
		status = rb_overlay_create(&t->overlay, camera->size_px[0], camera->size_px[1],
		                           err);
	if (!status && rb_captions_wanted(camera))
		status = rb_captions_create(&t->captions, model, camera, t->overlay, err);
	if (!status)
		status = rb_painter_create(&t->painter, model, camera, err);
	if (!status && camera->plot_count > 0)
		status = create_curves(t, err);
	if (status) {
		rb_take_destroy(t);
		*take = NULL;
	}
	return status;
}

void rb_take_destroy(struct rb_take *take)
{
	if (!take)
		return;
	rb_painter_destroy(take->painter);
	rb_curves_destroy(take->curves);
	rb_captions_destroy(take->captions);
	rb_overlay_destroy(take->overlay);
	rb_trails_release(&take->trails);
	rb_memory_free(take);
}

/* Raises the largest energy. */
static void see_energy(struct rb_take *take, const struct rb_frame *frame)
{
	const double kinetic = frame->numbers.kinetic_energy;
	const double total = kinetic + frame->numbers.potential_energy;

	take->largest_energy = fmax(take->largest_energy, fmax(kinetic, fabs(total)));
}

void rb_take_see(struct rb_take *take, const struct rb_frame *frame)
{
	see_energy(take, frame);
	rb_trails_add(&take->trails, frame);
	if (take->curves)
		rb_curves_add(take->curves, frame);
}

/* ---- what is written ---- */

/*
 * Label and number, padded to `places` digits before the point, so that the text behind keeps its
 * place.
 */
static void pad_number(char out[64], const char *label, double value, int decimals, int places)
{
	char number[48];

	snprintf(number, sizeof number, "%.*f", decimals, value);
	out[0] = '\0';
	for (int i = (int)strcspn(number, "."); i < places && i < 5; i++)
		strcat(out, figure_space);
	strcat(strcat(out, label), number);
}

/* The time and the film's speed. */
static void print_time(const struct rb_take *take, double time_s, char out[TEXT_SIZE])
{
	char number[64];

	pad_number(number, "", time_s / take->time_unit.size, take->time_decimals,
	           take->time_digits);
	snprintf(out, TEXT_SIZE, "t = %s %s%s%s", number, take->time_unit.name,
	         take->speed[0] ? "    " : "", take->speed);
}

/* 10^power, in superscripts: where no prefix is left. */
static void print_power(char out[48], int power)
{
	static const char *const digits[] = {
		"\xe2\x81\xb0", "\xc2\xb9",     "\xc2\xb2",     "\xc2\xb3",     "\xe2\x81\xb4",
		"\xe2\x81\xb5", "\xe2\x81\xb6", "\xe2\x81\xb7", "\xe2\x81\xb8", "\xe2\x81\xb9"};
	char number[16];

	snprintf(number, sizeof number, "%d", abs(power));
	strcpy(out, power < 0 ? "\xc3\x97"
	                        "10\xe2\x81\xbb"
	                      : "\xc3\x97"
	                        "10");
	for (const char *at = number; *at; at++)
		strcat(out, digits[*at - '0']);
	strcat(out, " J");
}

/* Energies with digits that suit the largest so far: small ones then look small. */
static void print_energy(const struct rb_take *take, double total, double kinetic,
                         char out[TEXT_SIZE])
{
	enum { UNITS = 9, JOULE = 3 };
	static const struct rb_unit_def units[UNITS] = {
		{"nJ", 1e-9}, {"\xc2\xb5J", 1e-6}, {"mJ", 1e-3}, {"J", 1},    {"kJ", 1e3},
		{"MJ", 1e6},  {"GJ", 1e9},         {"TJ", 1e12}, {"PJ", 1e15}};
	const double most = take->largest_energy;
	struct rb_unit_def unit = units[JOULE];
	char power_of_ten[48];

	for (int u = 0; most > 0 && u < UNITS; u++)
		if (u == 0 || most >= units[u].size)
			unit = units[u];
	if (most > 0 && isfinite(most) && (most < 1e-9 || most >= 1e18)) {
		const int power = 3 * (int)floor(log10(most) / 3);
		print_power(power_of_ten, power);
		unit = (struct rb_unit_def){power_of_ten, pow(10, power)};
	}
	const double size = unit.size, largest = most / size;
	const int before = largest >= 1 && largest < 1e15 ? 1 + (int)floor(log10(largest)) : 1;
	const int decimals = before < ENERGY_DIGITS ? ENERGY_DIGITS - before : 0;
	char e[64], k[64];
	pad_number(e, "E = ", total / size, decimals, before);
	pad_number(k, "(kinetic ", kinetic / size, decimals, before);
	snprintf(out, TEXT_SIZE, "%s %s %s)", e, unit.name, k);
}

/* The line of the energy: beside the time, or above it if the longest one would not fit. */
static int energy_line(const struct rb_take *take, double time_s, const struct rb_pixmap *picture)
{
	char text[TEXT_SIZE], time[TEXT_SIZE];

	if (!(take->camera->overlay & RB_OVERLAY_TIME))
		return 0;
	print_time(take, time_s, time);
	print_energy(take, -take->largest_energy, take->largest_energy, text);
	return rb_overlay_fits(take->overlay, picture->width, time, text) ? 0 : 1;
}

static void write_energy(struct rb_take *take, const struct rb_frame *frame,
                         struct rb_pixmap *picture)
{
	const double kinetic = frame->numbers.kinetic_energy;
	const double potential = frame->numbers.potential_energy;
	char text[TEXT_SIZE];

	print_energy(take, kinetic + potential, kinetic, text);
	rb_overlay_write(take->overlay, picture, RB_OVERLAY_BOTTOM_RIGHT,
	                 energy_line(take, frame->time_s, picture), text);
}

/* Whether the widest text and bar of a scale have room beside the title. */
static bool has_room_for_scale(const struct rb_take *take, const struct rb_pixmap *picture)
{
	const char *const title = take->model->scene->world.title;

	if (!(take->camera->overlay & RB_OVERLAY_TITLE) || !title)
		return true;
	return rb_overlay_fits(take->overlay, picture->width, title, "500 mm") &&
	       rb_overlay_fits(take->overlay, (int)((1 - bar_part) * picture->width), title, "");
}

/*
 * A bar of a round length, which changes only where the camera comes nearer or goes away; below a
 * title that leaves no room beside it.
 */
static void write_scale(struct rb_take *take, struct rb_pixmap *picture)
{
	static const struct rb_unit_def units[] = {
		{"nm", 1e-9},         {"\xc2\xb5m", 1e-6},     {"mm", 1e-3}, {"m", 1}, {"km", 1e3},
		{"AU", 149597870700}, {"ly", 9460730472580800}};
	enum { UNITS = sizeof units / sizeof *units };
	const struct rb_view *const view = rb_painter_view(take->painter);
	const double pixel = rb_view_pixel_at(view, view->aim_m);
	const double room = bar_part * picture->width * pixel;
	struct rb_unit_def unit = take->camera->length_unit;
	char text[TEXT_SIZE];

	if (!(room > 0 && isfinite(room)))
		return;
	for (int u = 0; !take->camera->length_unit.name && u < UNITS; u++)
		/* 0.1 AU is told as such, not as fifteen million kilometres */
		if (u == 0 || room >= (u < UNITS - 2 ? 1 : 0.1) * units[u].size)
			unit = units[u];
	const double decade = pow(10, floor(log10(room / unit.size)));
	const double lead = room / unit.size / decade;
	const double length = (lead >= 5 ? 5 : lead >= 2 ? 2 : 1) * decade;
	const int bar_px = (int)lrint(length * unit.size / pixel);
	snprintf(text, sizeof text, "%.12g %s", length, unit.name);
	rb_overlay_bar(take->overlay, picture, RB_OVERLAY_TOP_RIGHT,
	               has_room_for_scale(take, picture) ? 0 : 1, bar_px > 0 ? bar_px : 1, text);
}

/* Draws diagrams between what is written at the right. */
static void draw_curves(struct rb_take *take, const struct rb_frame *frame,
                        struct rb_pixmap *picture)
{
	const unsigned wanted = take->camera->overlay;
	const int above = !(wanted & RB_OVERLAY_SCALE)        ? 0
	                  : has_room_for_scale(take, picture) ? SCALE_LINES
	                                                      : SCALE_LINES + 1;
	const int below = wanted & RB_OVERLAY_ENERGY ? 1 + energy_line(take, frame->time_s, picture)
	                                             : 0;

	rb_curves_draw(take->curves, rb_overlay_lines_px(take->overlay, above),
	               rb_overlay_lines_px(take->overlay, below), picture);
}

/* The texts that the camera asks for. */
static void write_texts(struct rb_take *take, const struct rb_frame *frame,
                        struct rb_pixmap *picture)
{
	const unsigned wanted = take->camera->overlay;
	char time[TEXT_SIZE];

	if (wanted & RB_OVERLAY_TITLE)
		rb_overlay_write(take->overlay, picture, RB_OVERLAY_TOP_LEFT, 0,
		                 take->model->scene->world.title);
	if (wanted & RB_OVERLAY_TIME) {
		print_time(take, frame->time_s, time);
		rb_overlay_write(take->overlay, picture, RB_OVERLAY_BOTTOM_LEFT, 0, time);
	}
	if (wanted & RB_OVERLAY_SCALE)
		write_scale(take, picture);
	if (wanted & RB_OVERLAY_ENERGY)
		write_energy(take, frame, picture);
}

enum rb_status rb_take_draw(struct rb_take *take, const struct rb_frame *frame,
                            const struct rb_frame_shot *shot, struct rb_pixmap *picture,
                            struct rb_error *err)
{
	const enum rb_status status = rb_painter_draw(
		take->painter, frame, shot, take->trails.path_count > 0 ? &take->trails : NULL,
		picture, err);

	see_energy(take, frame);
	choose_speed_text(take, frame->time_s);
	if (!status && take->curves)
		draw_curves(take, frame, picture);
	if (!status && take->overlay)
		write_texts(take, frame, picture);
	if (!status && take->captions)
		rb_captions_draw(take->captions, frame, shot, rb_painter_view(take->painter),
		                 picture, take->camera->overlay & RB_OVERLAY_TITLE ? 1 : 0);
	return status;
}

void rb_take_heed(struct rb_take *take, const atomic_bool *cut)
{
	rb_painter_heed(take->painter, cut);
}

struct rb_painter_times rb_take_times(const struct rb_take *take)
{
	return rb_painter_times(take->painter);
}
