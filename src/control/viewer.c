/* SPDX-License-Identifier: MIT */
/*
 * The model of a console: which frame is shown, when the next one is due, from where it is seen,
 * what is logged. It never draws and never waits; the desk calls tick with the time of the clock
 * and asks when to come again.
 *
 * Three ways of going on: by the clock (pace), staying with the newest frame (live), or towards a
 * goal that the run has yet to compute (step). A view that runs out of frames restarts its pace at
 * the next frame; `wished` is the pace without such waits, and what it is behind decides whether
 * people are told that the simulation cannot keep up.
 */
#include "control/viewer.h"

#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/between.h"
#include "flow/frame.h"
#include "flow/schedule.h"
#include "script/shots.h"

/* ns between two looks when nothing goes on. */
static const uint64_t rest_ns = 250000000; /* between two looks when nothing goes on */
/*
 * A frame that is due within this part of a picture's time is taken for that picture: at equal
 * rates of frames and pictures rounding would else skip or repeat one.
 */
static const double early = 0.98;
/*
 * ns that the view may fall behind before that is reported: a run is asked five times a second, a
 * file is flushed once a second.
 */
static const uint64_t run_patience_ns = 250000000, file_patience_ns = 1500000000;
/* s of frames ahead of the view, with which the simulation counts as keeping up again. */
static const double ahead_s = 1.5; /* frames for so long: the simulation keeps up */

void rb_viewer_say(struct rb_viewer *viewer, const char *format, ...)
{
	char *const line = viewer->log[viewer->log_count++ % RB_VIEWER_LOG_LINES];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(line, RB_VIEWER_LOG_SIZE, format, arguments);
	va_end(arguments);
}

/* ---- cameras ---- */

struct rb_stand rb_viewer_stand(const struct rb_viewer *viewer)
{
	return rb_steer_stand(viewer->options.model, &viewer->camera, &viewer->frame,
	                      viewer->has_shot ? &viewer->shot : NULL);
}

void rb_viewer_aim(struct rb_viewer *viewer)
{
	const struct rb_viewer_options *const options = &viewer->options;
	struct rb_error err;

	viewer->picture++;
	viewer->has_shot = false;
	if (!viewer->has_frame || !rb_camera_has_functions(&viewer->camera) || !options->script)
		return;
	viewer->has_shot = true;
	if (rb_script_shot(options->script, options->model, &viewer->camera, &viewer->frame,
	                   &viewer->shot, &err) == RB_OK)
		return;
	rb_viewer_say(viewer, "%s", err.text);
	rb_viewer_take_camera(viewer, -1);
}

/*
 * Places a framed camera by what was seen so far, for a square picture: the screen's picture is
 * seldom higher than wide and its shape changes with the window.
 */
static void frame_all(struct rb_viewer *viewer)
{
	struct rb_camera_def *const camera = &viewer->camera;
	struct rb_camera_def square = *camera;
	char left_out[160];

	square.size_px[0] = square.size_px[1];
	square.height = (double)NAN;
	(void)rb_framing_aim(&viewer->framing, &square, left_out, sizeof left_out);
	camera->position = square.position;
	camera->look_at = square.look_at;
	camera->height = square.height;
}

void rb_viewer_take_camera(struct rb_viewer *viewer, int number)
{
	const struct rb_scene *const scene = viewer->options.model->scene;
	const bool given = number >= 0 && number < scene->camera_count;

	viewer->camera = given ? scene->cameras[number] : rb_steer_default(viewer->options.model);
	viewer->camera_index = given ? number : -1;
	viewer->camera_name = given && viewer->camera.name ? viewer->camera.name : "";
	viewer->camera_moved = false;
	viewer->followed = -1;
	if (viewer->camera.framed && viewer->has_frame)
		frame_all(viewer);
	rb_viewer_aim(viewer);
}

/*
 * Frames of a recording that are looked through to find where everything goes: spread over it, read
 * within a moment.
 */
enum { LOOKED_THROUGH = 256 };

/*
 * Shows frames of all of a recording to the framing, the last one always; of a run it is known as
 * it comes.
 */
static void look_through(struct rb_viewer *viewer)
{
	struct rb_source *const source = viewer->options.source;
	const struct rb_source_status *const status = rb_source_status(source);
	const uint64_t count = status->is_run ? 0 : status->row_count;
	const uint64_t step = 1 + count / LOOKED_THROUGH;
	const struct rb_frame *frame;
	uint64_t found;

	for (uint64_t row = 0; row < count;
	     row = row + 1 < count && row + step >= count ? count - 1 : row + step)
		if (rb_source_frame(source, row, &frame, &found, NULL) == RB_OK)
			(void)rb_framing_see(&viewer->framing, frame);
}

void rb_viewer_show_all(struct rb_viewer *viewer)
{
	struct rb_camera_def *const camera = &viewer->camera;

	camera->mount = -1;
	camera->framed = true;
	camera->aimed = false;
	camera->look_at.source = camera->up.source = RB_CAMERA_FIXED;
	camera->up.value = rb_camera_def_default().up.value;
	viewer->camera_moved = false;
	viewer->followed = -1;
	look_through(viewer);
	frame_all(viewer);
	rb_viewer_aim(viewer);
}

/* ---- life ---- */

enum rb_status rb_viewer_create(struct rb_viewer **viewer, const struct rb_viewer_options *options,
                                uint64_t now_ns, struct rb_error *err)
{
	struct rb_viewer *const v = *viewer = rb_memory_take(1, sizeof *v);

	if (!v)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot open a console: out of memory");
	v->options = *options;
	v->playing = true;
	v->live = options->live;
	v->speed = options->speed > 0 ? options->speed : 1;
	v->stops = options->model->scene->world.pause_on_collision;
	v->inspected = v->followed = -1;
	v->restarts = rb_source_status(options->source)->restarts;
	const enum rb_status status = rb_framing_init(&v->framing, options->model, err);
	if (status) {
		rb_viewer_destroy(v);
		*viewer = NULL;
		return status;
	}
	rb_viewer_take_camera(v, 0);
	rb_viewer_pace(v, now_ns);
	return RB_OK;
}

void rb_viewer_destroy(struct rb_viewer *viewer)
{
	if (!viewer)
		return;
	rb_frame_release(&viewer->frame);
	rb_framing_release(&viewer->framing);
	rb_memory_free(viewer);
}

/* ---- going on ---- */

/* The last row that there is; 0 also where there is none. */
static uint64_t last_row(const struct rb_viewer *viewer)
{
	const uint64_t count = rb_source_status(viewer->options.source)->row_count;

	return count > 0 ? count - 1 : 0;
}

bool rb_viewer_at_end(const struct rb_viewer *viewer)
{
	return viewer->row >= last_row(viewer);
}

void rb_viewer_pace(struct rb_viewer *viewer, uint64_t now_ns)
{
	viewer->pace = rb_pace_start(viewer->has_frame ? viewer->frame.time_s : 0, viewer->speed,
	                             now_ns);
	viewer->wished = viewer->pace;
	viewer->starved = false;
}

/*
 * Fetches a row and copies its frame. What cannot be had leaves the frame that is shown, and a line
 * in the log.
 */
static void fetch(struct rb_viewer *viewer, uint64_t row)
{
	const struct rb_frame *frame;
	struct rb_error err;
	uint64_t found;

	if (rb_source_frame(viewer->options.source, row, &frame, &found, &err) ||
	    rb_frame_copy(&viewer->frame, frame, &err)) {
		rb_viewer_say(viewer, "%s", err.text);
		return;
	}
	const bool first = !viewer->has_frame, framed = viewer->camera.framed;
	viewer->row = found;
	viewer->has_frame = true;
	if (first && framed)
		look_through(viewer);
	if (rb_framing_see(&viewer->framing, &viewer->frame) || first)
		viewer->reframes = true;
	if (viewer->reframes && framed && !viewer->camera_moved) {
		frame_all(viewer);
		viewer->reframes = false;
	}
	rb_viewer_aim(viewer);
}

void rb_viewer_go(struct rb_viewer *viewer, uint64_t row, uint64_t now_ns)
{
	viewer->live = viewer->has_goal = viewer->starved = false;
	viewer->due_ns = 0;
	fetch(viewer, row < last_row(viewer) ? row : last_row(viewer));
	rb_viewer_pace(viewer, now_ns);
}

/* The latest row that is due, not before the one that is shown. */
static uint64_t due_row(const struct rb_viewer *viewer, uint64_t now_ns)
{
	const struct rb_source *const source = viewer->options.source;
	uint64_t row = rb_source_row_at(source, rb_pace_time(&viewer->pace, now_ns));
	const uint64_t last = last_row(viewer);

	row = row < last ? row : last;
	/* times and moments are rounded apart: the moment decides */
	while (row < last && rb_pace_due(&viewer->pace, rb_source_time(source, row + 1)) <= now_ns)
		row++;
	while (row > viewer->row &&
	       rb_pace_due(&viewer->pace, rb_source_time(source, row)) > now_ns)
		row--;
	return row > viewer->row ? row : viewer->row;
}

/* s: the time of the frame that will be the next one; extrapolated where it does not exist yet. */
static double next_time(const struct rb_viewer *viewer)
{
	const struct rb_source *const source = viewer->options.source;
	const double next_s = rb_source_time(source, viewer->row + 1);
	const double before_s = viewer->row > 0 ? rb_source_time(source, viewer->row - 1) : 0;

	return next_s > viewer->frame.time_s ? next_s : 2 * viewer->frame.time_s - before_s;
}

/* Logs that the simulation cannot keep up with the view's speed. */
static void tell_starved(struct rb_viewer *viewer)
{
	const double factor = rb_source_status(viewer->options.source)->real_time_factor;

	if (isfinite(factor))
		rb_viewer_say(viewer,
		              "the simulation cannot keep up with speed %.4g: it makes %.3g",
		              viewer->speed, factor);
	else
		rb_viewer_say(viewer, "the simulation cannot keep up with speed %.4g",
		              viewer->speed);
}

/* At the last frame: the view ends with a recording, and waits with a run. */
static void reach_end(struct rb_viewer *viewer, uint64_t now_ns)
{
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);
	const double next_s = next_time(viewer);
	const uint64_t patience_ns = status->is_run ? run_patience_ns : file_patience_ns;

	if (!status->grows) {
		viewer->playing = viewer->live = false;
		return;
	}
	if (rb_pace_due(&viewer->pace, next_s) > now_ns)
		return;
	if (status->paused)
		viewer->wished = viewer->pace;
	const uint64_t due_ns = rb_pace_due(&viewer->wished, next_s);
	const bool starved = now_ns > due_ns && now_ns - due_ns > patience_ns;
	if (starved && !viewer->starved)
		tell_starved(viewer);
	viewer->starved = starved;
	/* whatever comes next is due at once, and what follows it in its time */
	viewer->pace = rb_pace_start(next_s, viewer->speed, now_ns);
}

/* Goes on to the row that is due, or to a collision before it where the view stops at them. */
static void play(struct rb_viewer *viewer, uint64_t now_ns)
{
	const uint64_t row = due_row(viewer, now_ns), last = last_row(viewer);
	uint64_t collision;

	RB_ASSERT(viewer->has_frame);
	if (row > viewer->row) {
		const bool stop = viewer->stops &&
		                  rb_source_collision(viewer->options.source, viewer->row, true,
		                                      &collision) &&
		                  collision <= row;
		const uint64_t to = stop ? collision : row;
		const uint64_t due_ns = rb_pace_due(&viewer->pace,
		                                    rb_source_time(viewer->options.source, to));
		viewer->lateness.skipped += to - viewer->row - 1;
		fetch(viewer, to);
		viewer->due_ns = due_ns;
		viewer->playing = !stop;
		if (stop)
			rb_viewer_say(viewer, "stopped at the collision of frame %llu",
			              (unsigned long long)viewer->frame.index);
	}
	if (viewer->playing && viewer->row >= last)
		reach_end(viewer, now_ns);
	if (rb_source_status(viewer->options.source)->end_s - viewer->frame.time_s >
	    ahead_s * viewer->speed) {
		viewer->wished = viewer->pace;
		viewer->starved = false;
	}
}

/* Goes on with the newest frame, or towards the goal. */
static void follow_run(struct rb_viewer *viewer)
{
	const uint64_t last = last_row(viewer);

	if (viewer->has_goal) {
		const uint64_t to = viewer->goal < last ? viewer->goal : last;
		if (to > viewer->row)
			fetch(viewer, to);
		viewer->has_goal = viewer->row < viewer->goal &&
		                   rb_source_status(viewer->options.source)->grows;
	} else if (viewer->live && viewer->playing) {
		if (last != viewer->row)
			fetch(viewer, last);
		else if (!rb_source_status(viewer->options.source)->grows)
			viewer->playing = viewer->live = false;
	}
}

/* Says how the run's process has ended, once it has, unless all went well. */
static void tell_end(struct rb_viewer *viewer)
{
	const struct rb_viewer_run *const run = viewer->options.run;
	int exit_code;

	if (!run->ended(run->user, &exit_code))
		return;
	viewer->wants_end = false;
	if (exit_code == 128 + SIGKILL)
		rb_viewer_say(viewer, "it was killed: by somebody, or for lack of memory");
	else if (exit_code != 0)
		rb_viewer_say(viewer, "its exit status is %d", exit_code);
}

/* Looks for news of the source and of what it says about itself. */
static void look(struct rb_viewer *viewer, uint64_t now_ns)
{
	struct rb_source *const source = viewer->options.source;
	const bool was_run = rb_source_status(source)->is_run;
	bool changed;
	struct rb_error err;

	if (rb_source_refresh(source, now_ns, false, &changed, &err))
		rb_viewer_say(viewer, "%s", err.text);
	const struct rb_source_status *const status = rb_source_status(source);
	if (was_run && !status->is_run) {
		rb_viewer_say(viewer, "the run has ended");
		viewer->wants_end = viewer->options.run != NULL;
	}
	if (viewer->wants_end)
		tell_end(viewer);
	if (status->is_run && status->restarts != viewer->restarts)
		viewer->wish = RB_VIEWER_RELOADS;
	/*
	 * the rest of the status may be some pictures old, the frames that the view waits for may
	 * not
	 */
	const bool waits = viewer->has_goal || (viewer->playing && !status->paused);
	if (viewer->has_frame && status->is_run && status->grows && waits &&
	    rb_viewer_at_end(viewer))
		(void)rb_source_newer(source, viewer->row);
}

void rb_viewer_tick(struct rb_viewer *viewer, uint64_t now_ns)
{
	RB_ASSERT(now_ns >= viewer->tick_ns);
	viewer->tick_ns = now_ns;
	viewer->due_ns = 0;
	look(viewer, now_ns);
	if (rb_source_status(viewer->options.source)->row_count == 0)
		return;
	if (!viewer->has_frame) {
		fetch(viewer, viewer->live ? last_row(viewer) : 0);
		rb_viewer_pace(viewer, now_ns);
		return;
	}
	if (viewer->live || viewer->has_goal)
		follow_run(viewer);
	else if (viewer->playing)
		play(viewer, now_ns);
}

void rb_viewer_shown(struct rb_viewer *viewer, uint64_t now_ns)
{
	if (viewer->due_ns > 0)
		rb_lateness_add(&viewer->lateness, viewer->due_ns, now_ns);
	viewer->due_ns = 0;
	viewer->drawn_count += viewer->has_frame && viewer->drawn != viewer->picture;
	viewer->drawn = viewer->picture;
}

uint64_t rb_viewer_next(const struct rb_viewer *viewer, uint64_t now_ns)
{
	const struct rb_source *const source = viewer->options.source;
	const struct rb_source_status *const status = rb_source_status(source);
	const double picture_s = 1 / viewer->options.fps;
	const uint64_t picture_ns = (uint64_t)(1e9 * picture_s), rest = now_ns + rest_ns;

	RB_ASSERT(viewer->options.fps > 0);
	if (!viewer->has_frame || viewer->has_goal || (viewer->live && viewer->playing) ||
	    (viewer->playing && viewer->row + 1 >= status->row_count)) {
		const uint64_t soon = viewer->tick_ns + picture_ns;
		return status->grows || !viewer->has_frame ? soon : rest;
	}
	if (!viewer->playing)
		return rest;
	/*
	 * from the time of this frame, not from when it came: what is late once must not stay late
	 */
	const double time_s = viewer->frame.time_s + viewer->speed * picture_s * early;
	uint64_t row = rb_source_row_at(source, time_s);
	row += rb_source_time(source, row) < time_s;
	row = row > viewer->row ? row : viewer->row + 1;
	row = row < last_row(viewer) ? row : last_row(viewer);
	const uint64_t due_ns = rb_pace_due(&viewer->pace, rb_source_time(source, row));
	return due_ns < rest ? due_ns : rest;
}

const char *rb_viewer_state(const struct rb_viewer *viewer)
{
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);

	if (!viewer->has_frame)
		return "waiting";
	if (status->is_run && status->paused && rb_viewer_at_end(viewer))
		return "paused";
	if (!viewer->playing && !viewer->has_goal)
		return rb_viewer_at_end(viewer) && !status->grows ? "at the end"
		       : status->is_run && !status->paused        ? "view paused"
		                                                  : "paused";
	return viewer->live ? "live" : "playing";
}
