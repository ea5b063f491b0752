/* SPDX-License-Identifier: MIT */
/*
 * A sink that turns frames into pictures at the camera's own rate. A picture between two frames is
 * drawn from an interpolated state (flow/between), so the previous frame is kept where one will be
 * needed. What the sink's thread owns needs no lock; tally and switches are shared.
 */
#include "film/film.h"

#include <inttypes.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "film/appearance.h"
#include "film/overlay.h"
#include "film/press.h"
#include "film/take.h"
#include "flow/between.h"
#include "flow/frame.h"
#include "flow/schedule.h"

/* Largest side, px: more than projectors have; OpenGL's targets have such a limit, too. */
enum { SIDE_MAX_PX = 16384 };

/* Largest number of pictures: four days at 30 a second; more is a mistake of units. */
static const uint64_t picture_count_max = 10000000;

struct rb_film {
	/* set before the sink is opened, then only read */
	struct rb_film_options options;
	struct rb_schedule schedule;
	uint64_t picture_count;
	char label[96]; /* "camera 'main'" */

	/* the sink's thread's */
	struct rb_take *take[RB_FILM_CELLS_MAX]; /* one for each cell, or for the whole picture */
	struct rb_pixmap whole;                  /* of cells */
	uint64_t next;                           /* picture */
	bool has_frame;         /* there was one before; its number, and how many lay between: */
	uint64_t index, stride; /* 0: not known yet */
	bool has_last;          /* `last` is that one */
	struct rb_frame last;
	struct rb_between between;
	size_t switched; /* switches that lie before `next` */

	atomic_bool cut; /* set by anybody */

	/* protected by lock */
	pthread_mutex_t lock;
	struct rb_press *press; /* set and unset in the sink's thread */
	struct rb_film_tally tally;
	double *switches; /* owned: after these times pictures are left out, drawn, left out, ... */
	size_t switch_count, switch_capacity;
};

/* What the printing of pictures needs, from the film's options. */
static struct rb_press_options press_options(const struct rb_film_options *options)
{
	const struct rb_camera_def *const camera = options->camera;
	const char *const title = options->model->scene->world.title;
	struct rb_press_options press = {.png = camera->png,
	                                 .still = options->still,
	                                 .video = camera->video,
	                                 .how = options->how,
	                                 .patience_s = options->patience_s,
	                                 .width = camera->size_px[0],
	                                 .height = camera->size_px[1],
	                                 .png_threads = options->encoder_threads,
	                                 .title = title};

	press.fps = isnan(camera->fps) ? options->model->frame_rate : camera->fps;
	if (title && *title)
		press.texts[press.text_count++] = (struct rb_png_text){"Title", title};
	if (camera->name)
		press.texts[press.text_count++] = (struct rb_png_text){"Camera", camera->name};
	press.texts[press.text_count++] = (struct rb_png_text){"Software", "rbsim"};
	if (options->command)
		press.texts[press.text_count++] = (struct rb_png_text){"Command", options->command};
	return press;
}

/* Number of pictures; one for a still. */
static uint64_t picture_count_of(const struct rb_film_options *options)
{
	const struct rb_schedule schedule = rb_schedule_of(
		options->camera, options->model->frame_rate, options->end_s);
	const uint64_t count = rb_schedule_count(&schedule);

	return options->still && count > 1 ? 1 : count;
}

/* Cells of a picture; one that is not divided is one. */
static int cell_count_of(const struct rb_film_options *options)
{
	return options->cell_count > 0 ? options->cell_count : 1;
}

static const struct rb_camera_def *camera_of(const struct rb_film_options *options, int cell)
{
	return options->cell_count > 0 ? &options->cells[cell].camera : options->camera;
}

enum rb_status rb_film_check(const struct rb_film_options *options, struct rb_error *err)
{
	const struct rb_press_options press = press_options(options);
	const struct rb_camera_def *const camera = options->camera;
	struct rb_overlay *overlay = NULL;
	struct rb_looks looks = {0};
	enum rb_status status = RB_OK;

	if (press.width < 1 || press.height < 1 || press.width > SIDE_MAX_PX ||
	    press.height > SIDE_MAX_PX)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "pictures of %d x %d pixels: 1 to %d a side are possible",
		               press.width, press.height, SIDE_MAX_PX);
	if (!(press.fps > 0) || !(camera->speed > 0))
		return RB_FAIL(
			err, RB_ERR_SCENE,
			"%g pictures per second at %g times the true speed: both must be positive",
			press.fps, camera->speed);
	const uint64_t count = picture_count_of(options);
	if (count > picture_count_max)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "a film of %" PRIu64 " pictures: at most %" PRIu64
		               " are possible (fps, speed, from and to say how many there are)",
		               count, picture_count_max);
	status = rb_looks_make(&looks, options->model, err);
	rb_looks_release(&looks);
	for (int c = 0; c < cell_count_of(options) && !status; c++)
		if (rb_take_writes(camera_of(options, c))) {
			status = rb_overlay_create(&overlay, press.width, press.height, err);
			rb_overlay_destroy(overlay);
		}
	return status ? status : rb_press_check(&press, err);
}

/* ---- the sink ---- */

static void destroy_takes(struct rb_film *film)
{
	for (int c = 0; c < RB_FILM_CELLS_MAX; c++) {
		rb_take_destroy(film->take[c]);
		film->take[c] = NULL;
	}
	rb_pixmap_release(&film->whole);
}

static enum rb_status create_takes(struct rb_film *film, struct rb_error *err)
{
	const struct rb_film_options *const options = &film->options;
	enum rb_status status = RB_OK;

	for (int c = 0; c < cell_count_of(options) && !status; c++) {
		status = rb_take_create(&film->take[c], options->model, camera_of(options, c), err);
		if (!status)
			rb_take_heed(film->take[c], &film->cut);
	}
	if (!status && options->cell_count > 0)
		status = rb_pixmap_init(&film->whole, options->camera->size_px[0],
		                        options->camera->size_px[1], err);
	if (status)
		destroy_takes(film);
	return status;
}

/* Creates painters and press in the sink's thread, to which the OpenGL contexts belong. */
static enum rb_status film_open(void *self, struct rb_error *err)
{
	struct rb_film *const film = self;
	struct rb_press_options options = press_options(&film->options);
	struct rb_press *press = NULL;

	options.cut = &film->cut;
	enum rb_status status = create_takes(film, err);
	if (!status)
		status = rb_press_create(&press, &options, err);
	/* a sink that fails to open is not closed, and the painters belong to this thread */
	if (status)
		destroy_takes(film);
	pthread_mutex_lock(&film->lock);
	film->press = press;
	pthread_mutex_unlock(&film->lock);
	return status;
}

/* Order of shots in a frame: by camera, then by picture. */
static bool is_before(const struct rb_frame_shot *shot, int camera, uint64_t picture)
{
	return shot->camera < camera || (shot->camera == camera && shot->picture < picture);
}

/*
 * Binary search for the shot of a cell of the next picture: slow motion may have thousands in one
 * frame.
 */
static enum rb_status find_shot(const struct rb_film *film, int cell, const struct rb_frame *frame,
                                const struct rb_frame_shot **shot, struct rb_error *err)
{
	const struct rb_camera_def *const camera = camera_of(&film->options, cell);
	const int number = film->options.number, cells = cell_count_of(&film->options);
	const uint64_t wanted = film->next * (uint64_t)cells + (uint64_t)cell;
	int low = 0, high = frame->shot_count;

	*shot = NULL;
	while (low < high) {
		const int middle = low + (high - low) / 2;
		if (is_before(&frame->shots[middle], number, wanted))
			low = middle + 1;
		else
			high = middle;
	}
	if (low < frame->shot_count && frame->shots[low].camera == number &&
	    frame->shots[low].picture == wanted) {
		*shot = &frame->shots[low];
		return RB_OK;
	}
	/* cameras without functions have a shot only where commands have moved them */
	if (!rb_camera_has_functions(camera))
		return RB_OK;
	return RB_FAIL(err, RB_ERR_BUG, "%s: its place at %.12g s is unknown", film->label,
	               rb_schedule_time(&film->schedule, film->next));
}

/* Copies the painter's times to the tally. */
static void note_times(struct rb_film *film)
{
	struct rb_painter_times times = {0, 0};

	for (int c = 0; c < cell_count_of(&film->options); c++) {
		const struct rb_painter_times one = rb_take_times(film->take[c]);
		times.draw_ns += one.draw_ns;
		times.read_ns += one.read_ns;
	}
	pthread_mutex_lock(&film->lock);
	film->tally.draw_ns = times.draw_ns;
	film->tally.read_ns = times.read_ns;
	pthread_mutex_unlock(&film->lock);
}

/* True if the film is switched off at that moment. */
static bool is_off(struct rb_film *film, double time_s)
{
	pthread_mutex_lock(&film->lock);
	while (film->switched < film->switch_count && film->switches[film->switched] < time_s)
		film->switched++;
	const bool off = film->switched % 2 == 1;
	film->tally.left_out += off;
	pthread_mutex_unlock(&film->lock);
	return off;
}

/* Copies the picture of a cell into the whole. */
static void place(struct rb_film *film, int cell, const struct rb_pixmap *part)
{
	const int *const at = film->options.cells[cell].at_px;
	struct rb_pixmap *const whole = &film->whole;

	RB_ASSERT(at[0] + part->width <= whole->width && at[1] + part->height <= whole->height);
	for (int y = 0; y < part->height; y++)
		memcpy(whole->rgba +
		               4 * ((size_t)(at[1] + y) * (size_t)whole->width + (size_t)at[0]),
		       part->rgba + 4 * (size_t)y * (size_t)part->width, 4 * (size_t)part->width);
}

/* The next picture, of one camera or of several. */
static enum rb_status draw_next(struct rb_film *film, const struct rb_frame *moment,
                                const struct rb_frame *frame, struct rb_pixmap *picture,
                                struct rb_error *err)
{
	const struct rb_frame_shot *shot;
	enum rb_status status = RB_OK;

	for (int c = 0; c < cell_count_of(&film->options) && !status; c++) {
		status = find_shot(film, c, frame, &shot, err);
		if (!status)
			status = rb_take_draw(film->take[c], moment, shot, picture, err);
		if (!status && film->options.cell_count > 0)
			place(film, c, picture);
	}
	if (film->options.cell_count > 0)
		*picture = film->whole;
	return status;
}

/* Draws and prints the next picture, of a moment not after `frame`, which has the camera's shot. */
static enum rb_status make_picture(struct rb_film *film, const struct rb_frame *moment,
                                   const struct rb_frame *frame, struct rb_error *err)
{
	const double time_s = rb_schedule_time(&film->schedule, film->next);
	struct rb_pixmap picture;

	if (is_off(film, time_s)) {
		film->next++;
		return RB_OK;
	}
	enum rb_status status = draw_next(film, moment, frame, &picture, err);
	if (status)
		return status == RB_ERR_INTERRUPT ? RB_OK : status; /* there is no next one */
	note_times(film);
	status = rb_press_print(film->press, &picture, film->next, time_s, err);
	film->next++;
	return status;
}

/* Time of the next picture; HUGE_VAL: there is none. */
static double next_time(struct rb_film *film)
{
	return film->next < film->picture_count && !atomic_load(&film->cut)
	               ? rb_schedule_time(&film->schedule, film->next)
	               : HUGE_VAL;
}

/* Pictures between the last frame and this one; those before the first frame are skipped. */
static enum rb_status make_earlier(struct rb_film *film, const struct rb_frame *frame,
                                   struct rb_error *err)
{
	/* without shots, which would be copied for each picture */
	struct rb_frame plain = *frame;
	enum rb_status status = RB_OK;
	double time_s;

	plain.shot_count = 0;
	while (!status && (time_s = next_time(film)) < frame->time_s) {
		const struct rb_frame *moment = frame;
		if (!film->has_frame) {
			film->next++;
			continue;
		}
		if (film->has_last) {
			status = rb_frame_between(&film->between, film->options.model, &film->last,
			                          &plain, time_s, err);
			moment = &film->between.frame;
		}
		if (!status)
			status = make_picture(film, moment, frame, err);
	}
	return status;
}

/*
 * Keeps a copy of the frame if a picture may fall before the next one, whose time is extrapolated
 * from the last interval.
 */
static enum rb_status remember(struct rb_film *film, const struct rb_frame *frame,
                               struct rb_error *err)
{
	film->stride = film->has_frame ? frame->index - film->index : 0;
	film->index = frame->index;
	film->has_frame = true;
	film->has_last = next_time(film) < HUGE_VAL &&
	                 (film->stride == 0 ||
	                  next_time(film) < rb_model_frame_time(film->options.model,
	                                                        frame->index + film->stride));
	struct rb_frame plain = *frame;
	plain.shot_count = 0;
	return film->has_last ? rb_frame_copy(&film->last, &plain, err) : RB_OK;
}

/* Pictures up to and including this frame's moment. */
static enum rb_status film_frame(void *self, const struct rb_frame *frame, struct rb_error *err)
{
	struct rb_film *const film = self;
	enum rb_status status;

	if (next_time(film) == HUGE_VAL)
		return RB_OK;
	/* before the trails get this frame's points */
	status = make_earlier(film, frame, err);
	for (int c = 0; c < cell_count_of(&film->options); c++)
		rb_take_see(film->take[c], frame);
	while (!status && next_time(film) == frame->time_s)
		status = make_picture(film, frame, frame, err);
	return status ? status : remember(film, frame, err);
}

/* Copies the press's tally; lock held. */
static void take_over_tally(struct rb_film *film)
{
	const struct rb_press_tally press = rb_press_tally(film->press);

	film->tally.pictures = press.pictures;
	film->tally.bytes = press.bytes;
	film->tally.png_ns = press.png_ns;
	film->tally.pipe_ns = press.pipe_ns;
	film->tally.wait_ns = press.wait_ns;
}

/* Finishes the film, however the run has ended. */
static enum rb_status film_close(void *self, const struct rb_outcome *outcome, struct rb_error *err)
{
	struct rb_film *const film = self;

	(void)outcome;
	destroy_takes(film);
	const enum rb_status status = rb_press_close(film->press, err);
	pthread_mutex_lock(&film->lock);
	take_over_tally(film);
	struct rb_press *const press = film->press;
	film->press = NULL;
	pthread_mutex_unlock(&film->lock);
	rb_press_destroy(press);
	return status;
}

enum rb_status rb_film_create(struct rb_film **film, struct rb_sink *sink,
                              const struct rb_film_options *options, struct rb_error *err)
{
	struct rb_film *const f = *film = rb_memory_take(1, sizeof *f);

	*sink = (struct rb_sink){0};
	if (!f)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot prepare a film: out of memory");
	f->options = *options;
	f->schedule = rb_schedule_of(options->camera, options->model->frame_rate, options->end_s);
	f->picture_count = picture_count_of(options);
	atomic_init(&f->cut, false);
	f->tally.picture_count = f->picture_count;
	const char *const word = options->cell_count > 0 ? "film" : "camera";
	if (options->camera->name)
		snprintf(f->label, sizeof f->label, "%s '%.60s'", word, options->camera->name);
	else
		snprintf(f->label, sizeof f->label, "%s %d", word, options->number + 1);
	unsigned fields = 0;
	for (int c = 0; c < cell_count_of(options); c++)
		fields |= rb_schedule_fields(camera_of(options, c), options->model, options->end_s);
	pthread_mutex_init(&f->lock, NULL);
	*sink = (struct rb_sink){.name = f->label,
	                         .lossless = true,
	                         .fields = fields,
	                         .self = f,
	                         .open = film_open,
	                         .frame = film_frame,
	                         .close = film_close};
	return RB_OK;
}

void rb_film_destroy(struct rb_film *film)
{
	if (!film)
		return;
	rb_press_destroy(film->press);
	rb_memory_free(film->switches);
	rb_frame_release(&film->last);
	rb_between_release(&film->between);
	pthread_mutex_destroy(&film->lock);
	rb_memory_free(film);
}

void rb_film_cut(struct rb_film *film)
{
	atomic_store(&film->cut, true);
}

enum rb_status rb_film_switch(struct rb_film *film, double time_s, bool on, struct rb_error *err)
{
	bool done = true;

	pthread_mutex_lock(&film->lock);
	if ((film->switch_count % 2 == 0) != on) {
		done = rb_memory_reserve(&film->switches, &film->switch_capacity,
		                         film->switch_count + 1, sizeof *film->switches);
		if (done)
			film->switches[film->switch_count++] = time_s;
	}
	pthread_mutex_unlock(&film->lock);
	if (!done)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot switch a film: out of memory");
	return RB_OK;
}

struct rb_film_tally rb_film_tally(const struct rb_film *film)
{
	struct rb_film *const f = (struct rb_film *)film; /* the lock is no part of what it says */

	pthread_mutex_lock(&f->lock);
	if (f->press)
		take_over_tally(f);
	const struct rb_film_tally tally = f->tally;
	pthread_mutex_unlock(&f->lock);
	return tally;
}
