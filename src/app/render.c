/* SPDX-License-Identifier: MIT */
#include "app/render.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/film_summary.h"
#include "app/films.h"
#include "app/json.h"
#include "app/progress.h"
#include "app/recorded.h"
#include "app/sheet.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/visible.h"
#include "flow/between.h"
#include "script/camera.h"

/* Frames ahead of the slowest camera: they are read faster than drawn. */
enum { SLOTS = 4 };

/* One call of the verb, or the late films of a run. */
struct render {
	const struct rb_options *options;
	const char *path; /* of the recording */
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	const struct rb_reading *reading;
	struct rb_loaded loaded;
	double end_s; /* time of the last frame that is there */
	struct rb_films_wish wish;
	char *output; /* owned: the film's name where nobody names it */
	struct rb_films *films;
	struct rb_ring *ring;
	struct rb_progress *progress;
	struct rb_outcome outcome;
	size_t sheet_bytes;
	double wall_s;
};

/* Whether a text is longer than an ending and ends with it. */
static bool ends_with(const char *text, const char *end)
{
	const size_t size = strlen(text), end_size = strlen(end);

	return size > end_size && strcmp(text + size - end_size, end) == 0;
}

/* Checks that the output's name goes with what is asked for. */
static enum rb_status check_output(const struct rb_options *options, struct rb_error *err)
{
	const char *const output = options->output;
	const bool single = options->frame >= 0 || options->contact_sheet;

	if (options->frame >= 0 && options->contact_sheet)
		return RB_FAIL(err, RB_ERR_USAGE, "option '--frame' contradicts '--contact-sheet'");
	if (single && (!output || !ends_with(output, ".png")))
		return RB_FAIL(err, RB_ERR_USAGE, "option '--%s' needs --output PICTURE.png%s%s%s",
		               options->frame >= 0 ? "frame" : "contact-sheet",
		               output ? " (got '" : "", output ? output : "", output ? "')" : "");
	if (single &&
	    !(isnan(options->fps) && isnan(options->speed) &&
	      (options->contact_sheet || (isnan(options->from_s) && isnan(options->to_s)))))
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"option '--%s' makes one picture: --fps and --speed%s say nothing for it",
			options->frame >= 0 ? "frame" : "contact-sheet",
			options->frame >= 0 ? ", --from and --to" : "");
	if (!output || single)
		return RB_OK;
	if (ends_with(output, ".png")) {
		if (!rb_camera_is_numbered(output))
			return RB_FAIL(
				err, RB_ERR_USAGE,
				"option '--output': '%s' must hold one %%d for the number of the "
				"picture, like frames/%%05d.png (one picture: --frame N)",
				output);
	} else if (!ends_with(output, ".mp4") && !ends_with(output, ".webm") &&
	           !ends_with(output, ".gif")) {
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--output': '%s' must end in .mp4, .webm, .gif or .png",
		               output);
	}
	return RB_OK;
}

/* Reads "1920x1080". */
static enum rb_status read_size(const char *text, int size_px[2], struct rb_error *err)
{
	char *end;
	const long width = strtol(text, &end, 10);
	const long height = *end == 'x' ? strtol(end + 1, &end, 10) : 0;

	if (text[strspn(text, "0123456789x")] != '\0' || *end != '\0' || width < 1 || height < 1 ||
	    width > RB_CAMERA_SIDE_MAX || height > RB_CAMERA_SIDE_MAX)
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"option '--size': '%s' is not of the form 1280x720, each from 1 to %d",
			text, RB_CAMERA_SIDE_MAX);
	size_px[0] = (int)width;
	size_px[1] = (int)height;
	return RB_OK;
}

/* Takes what the command line asks of films. */
static enum rb_status read_wish(struct render *render, struct rb_error *err)
{
	const struct rb_options *const options = render->options;
	struct rb_films_wish *const wish = &render->wish;

	*wish = (struct rb_films_wish){
		.names = options->camera,
		.from_s = options->from_s,
		.to_s = options->to_s,
		.fps = options->fps,
		.speed = options->speed,
		.output = options->output,
		.still = options->frame >= 0,
		.fallback = true,
		.recording = options->operand[0],
		.replace = options->force,
		.trust = options->trust,
		.patience_s = options->film_timeout_s,
	};
	if (options->from_s > options->to_s)
		return RB_FAIL(err, RB_ERR_USAGE, "option '--from' must not be after '--to'");
	const enum rb_status status = check_output(options, err);
	return !status && options->size ? read_size(options->size, wish->size_px, err) : status;
}

/* ---- the recording ---- */

/* Opens the recording and finds where it ends. */
static enum rb_status open_recording(struct render *render, struct rb_error *err)
{
	const char *const path = render->path;
	struct rb_frame frame;
	enum rb_status status = rb_recorded_open(&render->module, &render->reader, path, err);

	if (status)
		return status;
	render->reading = render->module->reader_reading(render->reader);
	if (render->reading->body_count > 0 && !(render->reading->fields & RB_FIELD_POSITION))
		return RB_FAIL(err, RB_ERR_INPUT,
		               "'%s' holds no positions ('fields' of record is without "
		               "\"position\"): there is nothing to film",
		               path);
	status = render->module->reader_frame(render->reader, render->reading->frame_count - 1,
	                                      &frame, err);
	if (status)
		return status;
	render->end_s = render->wish.end_s = frame.time_s;
	if (render->wish.from_s > render->end_s)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--from': '%s' holds frames up to %.9g s, not to %.9g s",
		               path, render->end_s, render->wish.from_s);
	return RB_OK;
}

/* Makes the time of the frame that --frame names that of a film of one picture. */
static enum rb_status aim_at_frame(struct render *render, struct rb_error *err)
{
	const uint64_t wanted = (uint64_t)render->options->frame;
	struct rb_frame frame;
	uint64_t row;
	enum rb_status status = rb_recorded_row_of(render->module, render->reader, wanted, &row,
	                                           err);

	if (!status)
		status = render->module->reader_frame(render->reader, row, &frame, err);
	if (status)
		return status;
	if (frame.index != wanted)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--frame': '%s' has no frame %" PRIu64
		               " (the nearest before is %" PRIu64 ")",
		               render->options->operand[0], wanted, frame.index);
	render->wish.from_s = render->wish.to_s = frame.time_s;
	return RB_OK;
}

/* Reads the cameras of --with, which come instead of those of the scene. */
static enum rb_status add_cameras(struct render *render, struct rb_error *err)
{
	const struct rb_options *const options = render->options;
	struct rb_scene *const scene = &render->loaded.scene;

	if (!options->with)
		return RB_OK;
	/* they come instead of those of the scene */
	scene->camera_count = scene->film_count = 0;
	const enum rb_status status = rb_script_add_cameras(render->loaded.script, options->with,
	                                                    &render->loaded.mistakes, err);
	if (!status && scene->camera_count == 0)
		return RB_FAIL(err, RB_ERR_SCENE, "'%s' defines no camera", options->with);
	return status;
}

/* ---- films ---- */

/* Hands one recorded frame to the films. */
static enum rb_status publish(struct render *render, uint64_t row, struct rb_error *err)
{
	struct rb_frame frame, *const slot = rb_ring_acquire(render->ring);
	enum rb_status status = render->module->reader_frame(render->reader, row, &frame, err);

	if (!status)
		status = rb_frame_copy(slot, &frame, err);
	if (!status)
		status = rb_films_shoot(render->films, slot, err);
	if (status)
		return status;
	const double time_s = slot->time_s;
	rb_ring_publish(render->ring);
	rb_progress_at(render->progress, time_s - render->wish.from_s);
	return RB_OK;
}

/*
 * Hands the recorded frames that the films need to them, from the one before the first picture to
 * the one behind the last.
 */
static enum rb_status feed(struct render *render, struct rb_error *err)
{
	const double first_s = rb_films_first_s(render->films);
	const double last_s = isnan(render->wish.to_s) ? render->end_s
	                                               : fmin(render->wish.to_s, render->end_s);
	uint64_t row, last;
	enum rb_status status = rb_recorded_row_at(render->module, render->reader, first_s, &row,
	                                           err);

	if (!status)
		status = rb_recorded_row_at(render->module, render->reader, last_s, &last, err);
	if (status)
		return status;
	/* the frame behind the last picture's time, to draw what lies before it */
	if (last + 1 < render->reading->frame_count)
		last++;
	/* after a signal the films are cut, which joining them tells */
	for (; !status && row <= last && !rb_progress_signal(render->progress); row++)
		status = publish(render, row, err);
	return status;
}

/* rb_progress_options.heed. */
static void cut_films(void *user, int signal)
{
	const struct render *const render = user;

	rb_films_cut(render->films, signal);
}

/* Names the film RUN.mp4 beside RUN.h5, where no camera says where its film goes. */
static enum rb_status name_output(struct render *render, struct rb_error *err)
{
	static const char end[] = ".h5", other[] = ".mp4";
	const char *const path = render->path;
	const size_t size = strlen(path) - (ends_with(path, end) ? strlen(end) : 0);

	render->output = rb_memory_take(size + sizeof other, 1);
	if (!render->output)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare films: out of memory");
	memcpy(render->output, path, size);
	memcpy(render->output + size, other, sizeof other);
	render->wish.output = render->output;
	return RB_OK;
}

/*
 * Makes the films. They are joined whatever happens before; the first failure is the one that is
 * reported.
 */
static enum rb_status film(struct render *render, struct rb_error *err)
{
	const struct rb_options *const options = render->options;
	const double from_s = isnan(render->wish.from_s) ? 0 : render->wish.from_s;
	const struct rb_progress_options progress = {
		.quiet = options->quiet || options->json,
		.heed = cut_films,
		.heed_user = render,
		.duration_s = (isnan(render->wish.to_s) ? render->end_s : render->wish.to_s) -
	                      from_s,
	};
	struct rb_error joined;

	rb_films_tell_missing(render->loaded.model, render->path, rb_films_fields(render->films),
	                      render->reading->fields);
	enum rb_status status = rb_films_frame(render->films, render->module, render->reader, err);
	if (status)
		return status;
	render->wish.from_s = from_s;
	status = rb_progress_start(&render->progress, &progress, err);
	if (!status)
		status = rb_ring_create(&render->ring, render->loaded.model, 0, SLOTS, err);
	if (!status)
		status = rb_films_start(render->films, render->ring, &render->outcome, err);
	if (!status)
		status = feed(render, err);
	render->outcome.status = status;
	render->outcome.reason = status && err ? err->text : "";
	if (render->ring)
		rb_ring_close(render->ring);
	const enum rb_status join_status = rb_films_join(render->films, &joined);
	if (join_status && !status) {
		if (err)
			*err = joined;
		status = join_status;
	}
	rb_progress_stop(render->progress);
	return status;
}

/* Prepares and makes the films. */
static enum rb_status make_films(struct render *render, struct rb_error *err)
{
	enum rb_status status = rb_films_create(&render->films, &render->loaded, &render->wish,
	                                        err);

	if (!status && !render->films) {
		status = name_output(render, err);
		if (!status)
			status = rb_films_create(&render->films, &render->loaded, &render->wish,
			                         err);
	}
	if (!status && !render->films) /* it begins after the end, which is told */
		status = RB_FAIL(err, RB_ERR_USAGE, "no camera of '%s' makes a film", render->path);
	return status ? status : film(render, err);
}

/* Where a camera without a position stands for the whole sheet. */
static enum rb_status frame_one(const struct render *render, const struct rb_camera_def *span,
                                struct rb_camera_def *camera, struct rb_error *err)
{
	camera->from_s = span->from_s;
	camera->to_s = span->to_s;
	return camera->framed ? rb_films_frame_camera(camera, render->loaded.model, render->module,
	                                              render->reader, "the camera", err)
	                      : RB_OK;
}

/* Makes a contact sheet. */
static enum rb_status sheet(struct render *render, struct rb_error *err)
{
	struct rb_camera_def camera;
	struct rb_film_cell *cells;
	int cell_count;
	enum rb_status status = rb_films_one_camera(&camera, &cells, &cell_count, &render->loaded,
	                                            &render->wish, err);
	if (status)
		return status;
	const struct rb_sheet sheet = {
		.loaded = &render->loaded,
		.module = render->module,
		.reader = render->reader,
		.camera = &camera,
		.cells = cells,
		.cell_count = cell_count,
		.path = render->options->output,
		.replace = render->options->force,
	};

	camera.to_s = fmin(camera.to_s, render->end_s);
	camera.from_s = fmin(camera.from_s, camera.to_s);
	for (int c = 0; c < cell_count && !status; c++)
		status = frame_one(render, &camera, &cells[c].camera, err);
	if (cell_count == 0)
		status = frame_one(render, &camera, &camera, err);
	if (!status)
		status = rb_sheet_make(&sheet, &render->sheet_bytes, err);
	rb_memory_free(cells);
	return status;
}

/* ---- telling ---- */

/* Prints what has been made. */
static void tell(const struct render *render, enum rb_status status, const struct rb_error *err)
{
	const struct rb_options *const options = render->options;
	struct rb_json json = {.file = stdout};
	char size[32];

	if (options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "file", options->operand[0]);
		rb_json_text(&json, "status", status ? "failed" : "complete");
		rb_json_count(&json, "exit_status", (uint64_t)rb_status_exit_code(status));
		rb_json_text(&json, "error", status ? err->text : NULL);
		rb_json_number(&json, "wall_time", render->wall_s);
		if (options->contact_sheet) {
			rb_json_text(&json, "sheet", options->output);
			rb_json_count(&json, "sheet_bytes", render->sheet_bytes);
		}
		rb_films_print_json(&json, render->films);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!options->quiet && !status && options->contact_sheet) {
		rb_print(stderr, "%s: %s\n", options->output,
		         rb_text_bytes(render->sheet_bytes, size));
	} else if (!options->quiet) {
		if (strcmp(render->reading->status, "complete") != 0)
			rb_print(stderr,
			         "rbsim: the recording is %s and holds frames up to %.6g s\n",
			         render->reading->status, render->end_s);
		rb_print(stderr, "%s, in %.3g s\n", options->operand[0], render->wall_s);
		rb_films_print(stderr, render->films);
	}
}

/* Everything before the first picture. */
static enum rb_status prepare(struct render *render, struct rb_error *err)
{
	enum rb_status status = read_wish(render, err);

	if (!status)
		status = open_recording(render, err);
	if (!status)
		status = rb_recorded_load(&render->loaded, render->reading, render->path,
		                          render->options->trust, err);
	if (!status && render->options->frame >= 0)
		status = aim_at_frame(render, err);
	if (!status)
		status = add_cameras(render, err);
	return status;
}

enum rb_status rb_render_late(struct rb_films *films, struct rb_loaded *loaded,
                              const struct rb_options *options, struct rb_error *err)
{
	struct render render = {.options = options,
	                        .path = loaded->output,
	                        .loaded = *loaded,
	                        .wish = {.from_s = (double)NAN, .to_s = (double)NAN},
	                        .films = films,
	                        .outcome = {.reason = ""}};

	if (!rb_films_begin_late(films))
		return RB_OK;
	enum rb_status status = open_recording(&render, err);
	if (!status)
		status = film(&render, err);
	rb_ring_destroy(render.ring);
	if (render.reader)
		render.module->reader_close(render.reader);
	return status;
}

int rb_render_main(const struct rb_options *options)
{
	struct render render = {
		.options = options, .path = options->operand[0], .outcome = {.reason = ""}};
	const uint64_t start_ns = rb_clock_now_ns();
	struct rb_error err = {0};
	enum rb_status status = prepare(&render, &err);
	const bool prepared = !status;
	int exit_code = 0;

	if (!status)
		status = options->contact_sheet ? sheet(&render, &err) : make_films(&render, &err);
	render.wall_s = (double)(rb_clock_now_ns() - start_ns) * 1e-9;
	if (prepared && (render.films || !status)) {
		tell(&render, status, &err);
		if (status)
			exit_code = rb_app_fail(options, &err);
	} else {
		exit_code = render.loaded.mistakes.count > 0
		                    ? rb_app_refuse_scene(options, &render.loaded, &err)
		                    : rb_app_refuse(options, &err);
	}
	rb_ring_destroy(render.ring);
	rb_films_destroy(render.films);
	rb_loaded_release(&render.loaded);
	rb_memory_free(render.output);
	if (render.reader)
		render.module->reader_close(render.reader);
	return rb_app_finish(options, exit_code);
}
