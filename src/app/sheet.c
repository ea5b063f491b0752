/* SPDX-License-Identifier: MIT */
#include "app/sheet.h"

#include <math.h>
#include <string.h>

#include "app/recorded.h"
#include "base/error.h"
#include "film/pixmap.h"
#include "film/png.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "flow/between.h"
#include "flow/frame.h"
#include "flow/schedule.h"
#include "script/shots.h"

/*
 * A sheet is 4 x 4 pictures, each CELL_SIDE pixels at its longer side, GAP pixels apart: 2
 * megapixels, what a screen shows at once.
 */
enum { COLUMNS = 4, ROWS = 4, CELL_SIDE = 480, GAP = 8 };

/* Everything of a sheet that is being drawn. */
struct drawing {
	const struct rb_sheet *sheet;
	const struct rb_film_module *film;
	/* what makes one picture: its cameras, in the size that they have on the sheet */
	int part_count, size_px[2];
	struct rb_film_cell part[RB_FILM_CELLS_MAX];
	struct rb_take *take[RB_FILM_CELLS_MAX];
	struct rb_pixmap whole;
	struct rb_frame before;
	struct rb_between between;
	uint64_t seen; /* rows that the take has seen */
};

/*
 * What lies at `time_s`: a frame of the recording, in `after`, or one between two. `*moment` is
 * borrowed until the next call. Trails want every frame on the way, all others only the two around
 * the moment.
 */
static enum rb_status moment_at(struct drawing *d, double time_s, const struct rb_frame **moment,
                                struct rb_frame *after, struct rb_error *err)
{
	const struct rb_sheet *const sheet = d->sheet;
	const uint64_t count = sheet->module->reader_reading(sheet->reader)->frame_count;
	uint64_t row;
	enum rb_status status = rb_recorded_row_at(sheet->module, sheet->reader, time_s, &row, err);

	/* trails want every frame on the way, all others only the two around the moment */
	bool remembers = false;
	for (int k = 0; k < d->part_count; k++)
		remembers |= d->part[k].camera.trail_count > 0 || d->part[k].camera.plot_count > 0;
	uint64_t from = remembers && d->seen < row ? d->seen : row;
	for (; !status && from <= row; from++) {
		status = sheet->module->reader_frame(sheet->reader, from, after, err);
		if (!status && from >= d->seen) {
			for (int k = 0; k < d->part_count; k++)
				d->film->take_see(d->take[k], after);
			d->seen = from + 1;
		}
	}
	*moment = after;
	if (status || time_s <= after->time_s || row + 1 >= count)
		return status;
	status = rb_frame_copy(&d->before, after, err);
	if (!status)
		status = sheet->module->reader_frame(sheet->reader, row + 1, after, err);
	if (!status)
		status = rb_frame_between(&d->between, sheet->loaded->model, &d->before, after,
		                          time_s, err);
	*moment = &d->between.frame;
	return status;
}

/* Copies a camera's picture into its part of a cell of the sheet. */
static void place(struct drawing *d, int k, const struct rb_pixmap *part, int cell)
{
	struct rb_pixmap *const whole = &d->whole;
	const int x = GAP + cell % COLUMNS * (d->size_px[0] + GAP) + d->part[k].at_px[0];
	const int y = GAP + cell / COLUMNS * (d->size_px[1] + GAP) + d->part[k].at_px[1];

	RB_ASSERT(cell >= 0 && cell < COLUMNS * ROWS);
	RB_ASSERT(x + part->width <= whole->width && y + part->height <= whole->height);
	for (int line = 0; line < part->height; line++)
		memcpy(whole->rgba + 4 * ((size_t)(y + line) * (size_t)whole->width + (size_t)x),
		       part->rgba + 4 * (size_t)line * (size_t)part->width,
		       4 * (size_t)part->width);
}

/* Draws the picture of a moment into its cell. */
static enum rb_status draw_cell(struct drawing *d, int cell, double time_s, struct rb_error *err)
{
	struct rb_frame_shot shot = {.picture = (uint64_t)cell};
	const struct rb_frame *moment;
	struct rb_frame after;
	struct rb_pixmap picture;
	enum rb_status status = moment_at(d, time_s, &moment, &after, err);

	for (int k = 0; k < d->part_count && !status; k++) {
		const struct rb_camera_def *const camera = &d->part[k].camera;

		if (rb_camera_has_functions(camera))
			status = rb_script_shot(d->sheet->loaded->script, d->sheet->loaded->model,
			                        camera, moment, &shot, err);
		if (!status)
			status = d->film->take_draw(d->take[k], moment, &shot, &picture, err);
		if (!status)
			place(d, k, &picture, cell);
	}
	return status;
}

/* Sizes and places on the sheet; the first camera tells the time. */
static void arrange(struct drawing *d)
{
	const struct rb_sheet *const sheet = d->sheet;
	const int *const size = sheet->camera->size_px;
	/* the longer side is that of a cell */
	const double scale = (double)CELL_SIDE / (size[0] > size[1] ? size[0] : size[1]);

	d->part_count = sheet->cell_count > 0 ? sheet->cell_count : 1;
	d->part[0] = (struct rb_film_cell){.camera = *sheet->camera};
	for (int i = 0; i < 2; i++)
		d->size_px[i] = (int)lround(fmax(1, scale * size[i]));
	for (int k = 0; k < d->part_count; k++) {
		struct rb_film_cell *const part = &d->part[k];

		if (sheet->cell_count > 0)
			*part = sheet->cells[k];
		for (int i = 0; i < 2; i++) {
			const int first = part->at_px[i];
			const int end = first + part->camera.size_px[i];
			part->at_px[i] = (int)lround(scale * first);
			/* at least a pixel, and within the whole */
			if (part->at_px[i] >= d->size_px[i])
				part->at_px[i] = d->size_px[i] - 1;
			const int wanted = (int)lround(scale * end) - part->at_px[i];
			part->camera.size_px[i] = wanted > 1 ? wanted : 1;
			if (part->at_px[i] + part->camera.size_px[i] > d->size_px[i])
				part->camera.size_px[i] = d->size_px[i] - part->at_px[i];
		}
		part->camera.overlay = k == 0 ? RB_OVERLAY_TIME : 0;
	}
}

/* Draws and writes the sheet. */
static enum rb_status draw(struct drawing *d, size_t *bytes, struct rb_error *err)
{
	const struct rb_sheet *const sheet = d->sheet;
	const int cells = COLUMNS * ROWS;
	const double from_s = sheet->camera->from_s, to_s = sheet->camera->to_s;

	arrange(d);
	const int width = GAP + COLUMNS * (d->size_px[0] + GAP);
	const int height = GAP + ROWS * (d->size_px[1] + GAP);
	d->whole = (struct rb_pixmap){width, height,
	                              rb_memory_take((size_t)width * (size_t)height, 4)};
	if (!d->whole.rgba)
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot draw a sheet of %d x %d pixels: out of memory", width,
		               height);
	memset(d->whole.rgba, 255, 4 * (size_t)width * (size_t)height);
	enum rb_status status = RB_OK;
	for (int k = 0; k < d->part_count && !status; k++)
		status = d->film->take_create(&d->take[k], sheet->loaded->model, &d->part[k].camera,
		                              err);
	for (int i = 0; i < cells && !status; i++)
		status = draw_cell(d, i, from_s + (to_s - from_s) * i / (cells - 1), err);
	if (!status)
		status = d->film->png_write(sheet->path, sheet->replace, &d->whole, NULL, bytes,
		                            err);
	return status;
}

enum rb_status rb_sheet_make(const struct rb_sheet *sheet, size_t *bytes, struct rb_error *err)
{
	struct drawing d = {.sheet = sheet};
	enum rb_status status = rb_outfile_check(sheet->path, sheet->replace, err);

	if (!status)
		status = rb_module_film(&d.film, err);
	if (!status)
		status = draw(&d, bytes, err);
	for (int k = 0; k < d.part_count; k++)
		if (d.take[k])
			d.film->take_destroy(d.take[k]);
	rb_memory_free(d.whole.rgba);
	rb_frame_release(&d.before);
	rb_between_release(&d.between);
	return status;
}
