/* SPDX-License-Identifier: MIT */
/*
 * Two sources behind one interface. A recording is read by rows; the time of each row and whether
 * it has a collision are held in memory (9 bytes a row), for seeking. A run is asked through its
 * socket, whose history holds only the last frames; older ones are read from its recording, as far
 * as that is flushed. So a row of a run is a frame's number, while rows of its recording may be
 * fewer (record every), and the two are related by time.
 *
 * A run may vanish at any moment. Every request can fail; then the source silently becomes the
 * recording, and the rows keep their meaning.
 */
#include "control/source.h"

#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/place.h"
#include "control/wire.h"
#include "flow/frame.h"

/*
 * s that a run may take for an answer: it answers between two frames, and a stuck one must not
 * freeze the console for longer.
 */
static const double answer_s = 2; /* that a run may take for an answer */
/* ns between two looks at a run: five a second, as fast as numbers can be read. */
static const uint64_t ask_ns = 200000000; /* between two looks at a run */
/* ns between two looks at a file, which is flushed as often. */
static const uint64_t look_ns = 1000000000; /* at a file, which is flushed as often */
/*
 * Looking takes at most this fraction (1 / 20) of the time: a long recording takes long to look
 * through.
 */
static const uint64_t look_share = 20; /* and no more than this part of the time */
/*
 * Requests for one search among the frames of a run without a recording: as many frames as a
 * history keeps.
 */
enum { COLLISION_LOOKS_MAX = 600 }; /* frames of a run without recording */

/* What of a recording is held in memory: as much as seeking in it needs. */
struct rows {
	uint64_t count;
	double *time_s;           /* owned, [count] */
	unsigned char *collision; /* owned, [count]: 1 where there were any */
};

struct rb_source {
	const struct rb_model *model;
	struct rb_client *client; /* NULL: no run, or it is gone */
	bool was_run;
	char *path; /* owned: of the recording, NULL: there is none */
	const struct rb_hdf5_module *module;
	struct rb_reader *reader; /* NULL: not there yet */
	ino_t inode;              /* of the file that the reader of a run has opened */
	dev_t device;
	char started[32]; /* when the run was, as its recording has it; "": not known */
	struct rows rows;
	struct rb_frame frame; /* that came through the socket */
	bool has_frame;        /* and is whole */
	struct rb_frame read;  /* of the file; its columns are the reader's */
	uint64_t kept_first, kept_last;
	bool has_kept;
	uint64_t next_ask_ns, next_look_ns, next_timeline_ns;
	bool looked_after_end; /* the reader has seen all that there will be */
	struct rb_source_status status;
	struct rb_source_bins bins;
};

/* ---- life ---- */

/* Nothing is known: NAN, and no collisions. */
static void clear_bins(struct rb_source_bins *bins)
{
	for (int i = 0; i < RB_SOURCE_BINS; i++) {
		bins->kinetic[i] = bins->potential[i] = bins->penetration[i] = (double)NAN;
		bins->collisions[i] = 0;
	}
}

/* A source with nothing in it; NULL: no memory, and `err` says so. `path` NULL: no recording. */
static struct rb_source *create(const char *path, const struct rb_model *model,
                                struct rb_error *err)
{
	struct rb_source *const source = rb_memory_take(1, sizeof *source);

	if (source && path)
		source->path = rb_memory_copy_text(path);
	if (!source || (path && !source->path)) {
		rb_source_destroy(source);
		(void)RB_FAIL(err, RB_ERR_MEMORY, "cannot view frames: out of memory");
		return NULL;
	}
	source->model = model;
	source->status.duration_s = model->duration_s;
	source->status.frame_count = model->frame_count;
	source->status.real_time_factor = (double)NAN;
	clear_bins(&source->bins);
	return source;
}

void rb_source_destroy(struct rb_source *source)
{
	if (!source)
		return;
	if (source->reader)
		source->module->reader_close(source->reader);
	rb_memory_free(source->rows.time_s);
	rb_memory_free(source->rows.collision);
	rb_frame_release(&source->frame);
	rb_memory_free(source->path);
	rb_memory_free(source);
}

/* ---- the recording ---- */

/* Fails. */
static enum rb_status no_memory(const struct rb_source *source, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot view '%s': out of memory",
	               source->path ? source->path : "a run");
}

/*
 * Grows the arrays for `count` rows; rows->count stays. False: no memory, and the arrays are as
 * they were.
 */
static bool make_room(struct rows *rows, uint64_t count)
{
	double *const time_s = rb_memory_grow(rows->time_s, rows->count, count, sizeof *time_s);

	if (!time_s)
		return false;
	rows->time_s = time_s;
	unsigned char *const collision = rb_memory_grow(rows->collision, rows->count, count, 1);
	if (!collision)
		return false;
	rows->collision = collision;
	return true;
}

/* The bin of a time, also of times outside the run. */
static int bin_of(const struct rb_source *source, double time_s)
{
	const double share = source->status.duration_s > 0 ? time_s / source->status.duration_s : 0;

	return (int)fmin(fmax(floor(share * RB_SOURCE_BINS), 0), RB_SOURCE_BINS - 1);
}

/*
 * Observables of a recording that the bins and the status are made of, in the order of
 * observable_names. TIME comes first: the others need it to find their bins.
 */
enum observable { TIME, KINETIC, POTENTIAL, PENETRATION, COLLISIONS, ROLLBACKS, STEP };
static const char *const observable_names[] = {
	"time",       "kinetic_energy", "potential_energy", "max_penetration",
	"collisions", "rollbacks",      "smallest_step"};
enum { OBSERVABLE_COUNT = sizeof observable_names / sizeof *observable_names };

/* Takes the value of an observable at a row into the bins and the status. */
static void take_value(struct rb_source *source, enum observable what, uint64_t row, double value)
{
	struct rb_source_status *const status = &source->status;
	const int bin = bin_of(source, source->rows.time_s[row]);

	switch (what) {
	case TIME:
		break;
	case KINETIC:
		source->bins.kinetic[bin] = value;
		break;
	case POTENTIAL:
		source->bins.potential[bin] = value;
		break;
	case PENETRATION:
		source->bins.penetration[bin] = fmax(source->bins.penetration[bin], value);
		status->max_penetration_m = fmax(status->max_penetration_m, value);
		break;
	case COLLISIONS:
		source->rows.collision[row] = value > 0;
		source->bins.collisions[bin] += (uint64_t)fmax(value, 0);
		status->collisions += (uint64_t)fmax(value, 0);
		break;
	case ROLLBACKS:
		status->rollbacks += (uint64_t)fmax(value, 0);
		break;
	case STEP:
	default:
		if (value > 0 && (status->smallest_step_s == 0 || value < status->smallest_step_s))
			status->smallest_step_s = value;
		break;
	}
}

/*
 * Reads all numbers of the recording, one observable after the other: each is one contiguous
 * dataset. Observables that a recording lacks are passed over, except the times.
 */
static enum rb_status take_numbers(struct rb_source *source, uint64_t count, struct rb_error *err)
{
	double *const values = rb_memory_take(count, sizeof *values);
	enum rb_status status = values && make_room(&source->rows, count) ? RB_OK
	                                                                  : no_memory(source, err);

	RB_ASSERT(count > 0);
	clear_bins(&source->bins);
	source->status.collisions = source->status.rollbacks = 0;
	source->status.smallest_step_s = source->status.max_penetration_m = 0;
	for (int what = 0; what < OBSERVABLE_COUNT && !status; what++) {
		double *const to = what == TIME ? source->rows.time_s : values;
		const enum rb_status read = source->module->reader_observable(
			source->reader, observable_names[what], 1, to, err);
		if (read && what == TIME)
			status = read;
		for (uint64_t row = 0; row < count && !read; row++)
			take_value(source, (enum observable)what, row, to[row]);
	}
	rb_memory_free(values);
	if (!status)
		source->rows.count = count;
	return status;
}

/* Whether its file is being written. */
static bool is_written(const struct rb_source *source)
{
	const int fd = open(source->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	const bool is = fd >= 0 && rb_place_is_written(fd);

	if (fd >= 0)
		close(fd);
	return is;
}

/* Takes the status from the recording, unless there is a run, which knows better. */
static void tell_recording(struct rb_source *source)
{
	const struct rb_reading *const reading = source->module->reader_reading(source->reader);
	struct rb_source_status *const status = &source->status;
	struct stat file;

	if (source->client)
		return;
	status->grows = strcmp(reading->status, "running") == 0;
	snprintf(status->state, sizeof status->state, "%s",
	         !status->grows       ? reading->status
	         : is_written(source) ? "growing"
	                              : "unfinished");
	status->bytes = stat(source->path, &file) == 0 ? (uint64_t)file.st_size : 0;
	if (source->was_run) {
		/* as its frames were numbered while it went on */
		const uint64_t rows = source->rows.count;
		const uint64_t last = rows > 0 ? rb_source_row_at(source,
		                                                  source->rows.time_s[rows - 1])
		                               : 0;
		status->row_count = rows > 0 && last + 1 > status->row_count ? last + 1
		                                                             : status->row_count;
		status->grows = false;
	} else {
		status->row_count = source->rows.count;
	}
	if (status->row_count > 0)
		status->end_s = rb_source_time(source, status->row_count - 1);
}

/* Looks at the file, takes what is new, and decides when to look again. */
static enum rb_status look(struct rb_source *source, bool *changed, struct rb_error *err)
{
	const uint64_t began_ns = rb_clock_now_ns();
	enum rb_status status = source->module->reader_refresh(source->reader, err);
	const struct rb_reading *const reading = source->module->reader_reading(source->reader);

	if (!status && (reading->frame_count != source->rows.count || source->rows.count == 0)) {
		if (reading->frame_count > 0)
			status = take_numbers(source, reading->frame_count, err);
		*changed = true;
	}
	if (!status)
		tell_recording(source);
	const uint64_t now_ns = rb_clock_now_ns(), took_ns = now_ns - began_ns;
	const uint64_t pause_ns = look_share * took_ns;
	source->next_look_ns = now_ns + (pause_ns > look_ns ? pause_ns : look_ns);
	return status;
}

/* Closes the recording of a run; it may be opened again. */
static void close_recording(struct rb_source *source)
{
	source->module->reader_close(source->reader);
	source->reader = NULL;
	source->rows.count = 0;
}

/*
 * Opens the recording of a run, which comes into being with its first frame; fails silently until
 * it does. Until then an older one may stand under its name, and stays there if the run is killed.
 */
static void open_late(struct rb_source *source)
{
	struct rb_error err;
	struct stat file;

	if (!source->path || stat(source->path, &file) != 0)
		return;
	if (source->reader && (file.st_ino != source->inode || file.st_dev != source->device))
		close_recording(source);
	if (source->reader || rb_module_hdf5(&source->module, &err))
		return;
	if (source->module->reader_open(&source->reader, source->path, &err)) {
		source->reader = NULL;
		return;
	}
	source->inode = file.st_ino;
	source->device = file.st_dev;
	const struct rb_reading *const reading = source->module->reader_reading(source->reader);
	if ((source->client && strcmp(reading->status, "running") != 0) ||
	    (*source->started && strcmp(reading->started, source->started) != 0))
		close_recording(source);
}

enum rb_status rb_source_of_recording(struct rb_source **source, const char *path,
                                      const struct rb_model *model, struct rb_error *err)
{
	bool changed;

	*source = create(path, model, err);
	if (!*source)
		return RB_ERR_MEMORY;
	enum rb_status status = rb_module_hdf5(&(*source)->module, err);
	if (!status)
		status = (*source)->module->reader_open(&(*source)->reader, path, err);
	if (!status)
		status = look(*source, &changed, err);
	if (status) {
		rb_source_destroy(*source);
		*source = NULL;
	}
	return status;
}

/* ---- the run ---- */

/*
 * The text behind "KEY " in an answer, up to its line's end; NULL: there is no such line, as from
 * an older run.
 */
static const char *line_of(const char *lines, const char *key)
{
	const size_t size = strlen(key);

	while (lines && *lines) {
		if (strncmp(lines, key, size) == 0 && lines[size] == ' ')
			return lines + size + 1;
		lines = strchr(lines, '\n');
		lines += lines ? 1 : 0;
	}
	return NULL;
}

/* The number of a line; NAN: there is none. */
static double number_of(const char *lines, const char *key)
{
	const char *const text = line_of(lines, key);

	return text ? strtod(text, NULL) : (double)NAN;
}

/* The whole number of a line; 0: there is none. */
static uint64_t count_of(const char *lines, const char *key)
{
	const char *const text = line_of(lines, key);

	return text ? strtoull(text, NULL, 10) : 0;
}

/* Whether a line's text is this word. */
static bool word_is(const char *text, const char *word)
{
	const size_t size = strlen(word);

	return text && strncmp(text, word, size) == 0 && (text[size] == '\n' || text[size] == '\0');
}

/* Takes an answer to "status". */
static void take_status(struct rb_source *source, const char *lines)
{
	struct rb_source_status *const status = &source->status;
	const char *const state = line_of(lines, "state");
	const char *const kept = line_of(lines, "kept"), *const ring = line_of(lines, "ring");

	snprintf(status->state, sizeof status->state, "%.*s", state ? (int)strcspn(state, "\n") : 0,
	         state ? state : "");
	status->is_run = true;
	status->paused = word_is(state, "paused") || word_is(state, "pausing");
	status->grows = !word_is(state, "ended");
	status->stops_at_collision = word_is(line_of(lines, "stop-at-collision"), "on");
	status->frame_count = count_of(lines, "frames");
	status->duration_s = number_of(lines, "duration");
	status->restarts = count_of(lines, "restarts");
	status->real_time_factor = number_of(lines, "real-time-factor");
	status->smallest_step_s = number_of(lines, "smallest-step");
	status->max_penetration_m = number_of(lines, "max-penetration");
	status->collisions = count_of(lines, "collisions");
	status->rollbacks = count_of(lines, "rollbacks");
	status->bytes = count_of(lines, "recording-bytes");
	if (!ring || sscanf(ring, "%d %d", &status->ring_used, &status->ring_slots) != 2)
		status->ring_used = status->ring_slots = 0;
	source->has_kept = kept && sscanf(kept, "%" SCNu64 " %" SCNu64, &source->kept_first,
	                                  &source->kept_last) == 2;
	status->row_count = source->has_kept ? source->kept_last + 1 : 0;
	status->end_s = source->has_kept ? rb_source_time(source, source->kept_last) : 0;
	if (!source->has_kept)
		return;
	const int bin = bin_of(source, number_of(lines, "time"));
	source->bins.kinetic[bin] = number_of(lines, "kinetic-energy");
	source->bins.potential[bin] = number_of(lines, "potential-energy");
}

/*
 * Takes an answer to "timeline": without a recording the marks of collisions come from the run, one
 * digit for each part.
 */
static void take_timeline(struct rb_source *source, const char *lines)
{
	const char *const marks = line_of(lines, "collisions");
	const size_t count = marks ? strcspn(marks, "\n") : 0;

	for (int i = 0; i < RB_SOURCE_BINS && count > 0; i++) {
		const char mark = marks[(size_t)i * count / RB_SOURCE_BINS];
		source->bins.collisions[i] = mark > '0' && mark <= '9' ? (uint64_t)(mark - '0') : 0;
	}
}

/* The run is gone: what is left is its recording. */
static void lose(struct rb_source *source)
{
	source->client = NULL;
	source->has_kept = false;
	source->status.is_run = source->status.paused = source->status.grows = false;
	source->status.stops_at_collision = false;
	snprintf(source->status.state, sizeof source->status.state, "ended");
	source->next_look_ns = 0;
}

/*
 * Asks the run how it is; without a recording, now and then also for its time line. Failing, the
 * run is gone.
 */
static void ask(struct rb_source *source, bool *changed)
{
	const uint64_t rows = source->status.row_count;
	const bool paused = source->status.paused;
	const char *lines;
	struct rb_error err;
	size_t size;

	RB_ASSERT(source->client != NULL);
	if (rb_client_request(source->client, "status", answer_s, &lines, &size, &err)) {
		lose(source);
		*changed = true;
		return;
	}
	take_status(source, lines);
	*changed |= source->status.row_count != rows || source->status.paused != paused;
	if (source->reader || rb_clock_now_ns() < source->next_timeline_ns)
		return;
	source->next_timeline_ns = rb_clock_now_ns() + look_ns;
	if (rb_client_request(source->client, "timeline", answer_s, &lines, &size, &err) == RB_OK)
		take_timeline(source, lines);
}

/* Asks the run when it was started, by which its recording is known. */
static void ask_start(struct rb_source *source)
{
	static const char key[] = "started ";
	const char *lines;
	size_t size;

	if (rb_client_request(source->client, "hello", answer_s, &lines, &size, NULL))
		return;
	for (const char *line = lines; line && *line; line += *line == '\n') {
		const size_t length = strcspn(line, "\n");
		if (strncmp(line, key, sizeof key - 1) == 0)
			snprintf(source->started, sizeof source->started, "%.*s",
			         (int)(length - (sizeof key - 1)), line + sizeof key - 1);
		line += length;
	}
}

enum rb_status rb_source_of_run(struct rb_source **source, struct rb_client *client,
                                const char *recording, const struct rb_model *model,
                                struct rb_error *err)
{
	bool changed;

	*source = create(recording, model, err);
	if (!*source)
		return RB_ERR_MEMORY;
	(*source)->client = client;
	(*source)->was_run = true;
	(*source)->status.is_run = true;
	ask_start(*source);
	return rb_source_refresh(*source, rb_clock_now_ns(), true, &changed, err);
}

/* ---- both ---- */

enum rb_status rb_source_refresh(struct rb_source *source, uint64_t now_ns, bool now, bool *changed,
                                 struct rb_error *err)
{
	*changed = false;
	if (source->client && (now || now_ns >= source->next_ask_ns)) {
		ask(source, changed);
		source->next_ask_ns = now_ns + ask_ns;
	}
	if (source->looked_after_end || (now_ns < source->next_look_ns && !now))
		return RB_OK;
	if (source->was_run)
		open_late(source);
	source->next_look_ns = now_ns + look_ns;
	if (!source->reader)
		return RB_OK;
	struct rb_error own;
	const enum rb_status status = look(source, changed, &own);
	/* a recording that goes on after a restart is another file under the same name */
	if (status && source->client) {
		close_recording(source);
		return RB_OK;
	}
	if (status && err)
		*err = own;
	source->looked_after_end = !source->client && !source->status.grows;
	return status;
}

const struct rb_source_status *rb_source_status(const struct rb_source *source)
{
	return &source->status;
}

const struct rb_source_bins *rb_source_bins(const struct rb_source *source)
{
	return &source->bins;
}

double rb_source_time(const struct rb_source *source, uint64_t row)
{
	if (source->was_run)
		return rb_model_frame_time(source->model, row);
	return row < source->rows.count ? source->rows.time_s[row] : source->status.end_s;
}

uint64_t rb_source_row_at(const struct rb_source *source, double time_s)
{
	uint64_t low = 0, high = source->status.row_count;

	if (source->was_run && high < source->model->frame_count)
		high = source->model->frame_count;
	while (high - low > 1) {
		const uint64_t middle = low + (high - low) / 2;
		if (rb_source_time(source, middle) > time_s)
			high = middle;
		else
			low = middle;
	}
	return low;
}

/* The last row of the recording that is not after a time; 0 where all are. */
static uint64_t recorded_row(const struct rb_source *source, double time_s)
{
	uint64_t low = 0, high = source->rows.count;

	RB_ASSERT(source->rows.count > 0);
	while (high - low > 1) {
		const uint64_t middle = low + (high - low) / 2;
		if (source->rows.time_s[middle] > time_s)
			high = middle;
		else
			low = middle;
	}
	return low;
}

/* Reads the frame of a row, or the last one before it, from the recording. */
static enum rb_status frame_of_file(struct rb_source *source, uint64_t row,
                                    const struct rb_frame **frame, uint64_t *found,
                                    struct rb_error *err)
{
	const uint64_t recorded = source->was_run
	                                  ? recorded_row(source, rb_source_time(source, row))
	                                  : row;
	const uint64_t last = source->rows.count - 1;
	const enum rb_status status = source->module->reader_frame(
		source->reader, recorded < last ? recorded : last, &source->read, err);

	RB_ASSERT(source->rows.count > 0);
	*frame = &source->read;
	*found = source->was_run ? source->read.index : recorded < last ? recorded : last;
	return status;
}

/* Reads an answer to "frame" or "newer" into the source's frame. */
static enum rb_status take_frame(struct rb_source *source, const char *answer, struct rb_error *err)
{
	const enum rb_status status = rb_wire_read_frame(&source->frame, source->model->body_count,
	                                                 answer, strcspn(answer, "\n"), err);

	source->has_frame = !status;
	return status;
}

/*
 * A frame that the run still keeps, UINT64_MAX: its newest. One that is already here is not asked
 * for again.
 */
static enum rb_status frame_of_run(struct rb_source *source, uint64_t row,
                                   const struct rb_frame **frame, uint64_t *found,
                                   struct rb_error *err)
{
	char line[64];
	const char *answer;
	size_t size;

	RB_ASSERT(source->client != NULL);
	if (row == UINT64_MAX)
		snprintf(line, sizeof line, "frame all");
	else
		snprintf(line, sizeof line, "frame %" PRIu64 " all", row);
	enum rb_status status = RB_OK;
	if (!source->has_frame || source->frame.index != row) {
		status = rb_client_request(source->client, line, answer_s, &answer, &size, err);
		if (!status)
			status = take_frame(source, answer, err);
	}
	if (status)
		return status;
	*frame = &source->frame;
	*found = source->frame.index;
	return status;
}

void rb_source_ask(struct rb_source *source)
{
	bool changed = false;

	if (source->client)
		ask(source, &changed);
}

bool rb_source_newer(struct rb_source *source, uint64_t row)
{
	struct rb_source_status *const status = &source->status;
	const char *answer;
	char line[64];
	size_t size;

	if (!source->client || !source->has_kept)
		return false;
	snprintf(line, sizeof line, "newer %" PRIu64 " all", row);
	if (rb_client_request(source->client, line, answer_s, &answer, &size, NULL)) {
		source->next_ask_ns = 0; /* which finds out what is the matter */
		return false;
	}
	if (size == 0 || take_frame(source, answer, NULL))
		return false;
	source->kept_last = source->frame.index;
	status->row_count = source->kept_last + 1;
	status->end_s = source->frame.time_s;
	return true;
}

enum rb_status rb_source_frame(struct rb_source *source, uint64_t row,
                               const struct rb_frame **frame, uint64_t *found, struct rb_error *err)
{
	const bool kept = source->client && source->has_kept;

	if (kept && row >= source->kept_first) {
		const uint64_t wanted = row < source->kept_last ? row : source->kept_last;
		if (frame_of_run(source, wanted, frame, found, err) == RB_OK)
			return RB_OK;
	}
	/*
	 * also where it lies between what was flushed and what is kept: then the last one that was
	 * flushed
	 */
	if (source->rows.count > 0)
		return frame_of_file(source, row, frame, found, err);
	if (kept)
		return frame_of_run(source, UINT64_MAX, frame, found, err);
	return RB_FAIL(err, RB_ERR_INPUT, "frame %" PRIu64 " is neither kept nor recorded", row);
}

/* Searches the rows of the file behind or before one of them. */
static bool collision_of_file(const struct rb_source *source, uint64_t row, bool forward,
                              uint64_t *found)
{
	const unsigned char *const marks = source->rows.collision;

	if (forward) {
		for (uint64_t i = row + 1; i < source->rows.count; i++)
			if (marks[i]) {
				*found = i;
				return true;
			}
		return false;
	}
	for (uint64_t i = row < source->rows.count ? row : source->rows.count; i > 0; i--)
		if (marks[i - 1]) {
			*found = i - 1;
			return true;
		}
	return false;
}

/* Searches the frames that the run keeps, with one request each. */
static bool collision_of_run(struct rb_source *source, uint64_t row, bool forward, uint64_t *found)
{
	const struct rb_frame *frame;

	for (int looks = 0; looks < COLLISION_LOOKS_MAX; looks++) {
		if (forward ? row >= source->kept_last : row <= source->kept_first)
			return false;
		row = forward ? row + 1 : row - 1;
		if (row < source->kept_first || row > source->kept_last ||
		    frame_of_run(source, row, &frame, found, NULL))
			return false;
		if (frame->numbers.collisions > 0)
			return true;
	}
	return false;
}

bool rb_source_collision(struct rb_source *source, uint64_t row, bool forward, uint64_t *found)
{
	uint64_t in_file = row;

	if (source->was_run && source->rows.count > 0)
		in_file = recorded_row(source, rb_source_time(source, row));
	if (source->rows.count > 0 && collision_of_file(source, in_file, forward, &in_file)) {
		*found = source->was_run ? rb_source_row_at(source, source->rows.time_s[in_file])
		                         : in_file;
		return true;
	}
	return source->client && source->has_kept && collision_of_run(source, row, forward, found);
}

enum rb_status rb_source_tell(struct rb_source *source, const char *line, const char **answer,
                              struct rb_error *err)
{
	size_t size;

	*answer = "";
	if (!source->client)
		return RB_FAIL(err, RB_ERR_USAGE, "no run is in progress");
	const enum rb_status status = rb_client_request(source->client, line, answer_s, answer,
	                                                &size, err);
	source->next_ask_ns = 0;
	return status;
}
