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
	struct rb_camera_def camera; /* that of a cell */
	struct rb_take *take;
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
	uint64_t from = d->camera.trail_count > 0 && d->seen < row ? d->seen : row;
	for (; !status && from <= row; from++) {
		status = sheet->module->reader_frame(sheet->reader, from, after, err);
		if (!status && from >= d->seen) {
			d->film->take_see(d->take, after);
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

/* Copies a picture into its cell of the sheet. */
static void place(struct rb_pixmap *whole, const struct rb_pixmap *part, int cell)
{
	const int x = GAP + cell % COLUMNS * (part->width + GAP);
	const int y = GAP + cell / COLUMNS * (part->height + GAP);

	RB_ASSERT(cell >= 0 && cell < COLUMNS * ROWS);
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

	if (!status && rb_camera_has_functions(&d->camera))
		status = rb_script_shot(d->sheet->loaded->script, d->sheet->loaded->model,
		                        &d->camera, moment, &shot, err);
	if (!status)
		status = d->film->take_draw(d->take, moment, &shot, &picture, err);
	if (!status)
		place(&d->whole, &picture, cell);
	return status;
}

/* Draws and writes the sheet. */
static enum rb_status draw(struct drawing *d, size_t *bytes, struct rb_error *err)
{
	const struct rb_sheet *const sheet = d->sheet;
	const int cells = COLUMNS * ROWS;
	const double from_s = sheet->camera->from_s, to_s = sheet->camera->to_s;
	struct rb_camera_def *const camera = &d->camera;

	*camera = *sheet->camera;
	/* the longer side is that of a cell */
	const int longer = sheet->camera->size_px[0] > sheet->camera->size_px[1] ? 0 : 1;
	const double scale = (double)CELL_SIDE / sheet->camera->size_px[longer];
	for (int i = 0; i < 2; i++)
		camera->size_px[i] = (int)lround(fmax(1, scale * sheet->camera->size_px[i]));
	camera->overlay = RB_OVERLAY_TIME;
	const int width = GAP + COLUMNS * (camera->size_px[0] + GAP);
	const int height = GAP + ROWS * (camera->size_px[1] + GAP);
	d->whole = (struct rb_pixmap){width, height,
	                              rb_memory_take((size_t)width * (size_t)height, 4)};
	if (!d->whole.rgba)
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot draw a sheet of %d x %d pixels: out of memory", width,
		               height);
	memset(d->whole.rgba, 255, 4 * (size_t)width * (size_t)height);
	enum rb_status status = d->film->take_create(&d->take, sheet->loaded->model, camera, err);
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
	if (d.take)
		d.film->take_destroy(d.take);
	rb_memory_free(d.whole.rgba);
	rb_frame_release(&d.before);
	rb_between_release(&d.between);
	return status;
}
