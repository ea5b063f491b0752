/* SPDX-License-Identifier: MIT */
#include "sink/reader.h"

#include "base/arena.h"
#include "base/memory.h"
#include "sink/h5about.h"
#include "sink/h5frames.h"
#include "sink/h5input.h"
#include "sink/h5reading.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_SIZE = 600 };
/* Columns of a frame: the known ones and the scene's probes. */
enum { COLUMNS_MAX = RB_FRAMES_COLUMNS_MAX + RB_MEASURES_MAX };
static const double block_bytes = 1 << 20; /* of a frame's columns, read in one go */

/* A column as it stands in the file. */
struct column {
	hid_t dataset; /* -1: there is none */
	hsize_t rows;
	rb_h5_shape row;
	enum rb_h5_kind kind; /* in memory */
	size_t row_bytes;     /* in memory */
	unsigned char *block; /* owned: rows [block_first, block_first + block_count) */
};

struct table {
	struct column cells[RB_TABLE_COLUMNS_MAX];
	int count; /* of columns; 0: not recorded */
	hsize_t rows;
	unsigned char *rows_out; /* owned: structs of a frame */
	size_t rows_capacity;
	unsigned char *cells_out;
	size_t cells_capacity;
};

struct rb_reader {
	char *path;
	struct rb_input input;
	struct rb_arena arena; /* texts and lists */
	struct rb_reading reading;
	char *status, *reason, *state_hash, *ended; /* of reading; they change */
	size_t room[4];

	struct column sources[RB_FRAMES_SOURCE_COUNT];
	struct column probes[RB_MEASURES_MAX]; /* [reading.probe_count] */
	double probe_values[RB_MEASURES_MAX];  /* of the frame that was read last */
	double result_values[RB_MEASURES_MAX]; /* of reading */
	struct column step, time, event_end, contact_end;
	struct table events, contacts;

	hsize_t block_rows; /* room of every block */
	hsize_t block_first, block_count;
};

static struct rb_reading_source source_of(struct rb_reader *reader)
{
	return (struct rb_reading_source){.path = reader->path,
	                                  .input = &reader->input,
	                                  .arena = &reader->arena,
	                                  .reading = &reader->reading};
}

static enum rb_status no_memory(const struct rb_reader *reader, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", reader->path);
}

/* The scene's results as they are now; NAN those that cannot be read. */
static void read_results(struct rb_reader *reader)
{
	const struct rb_reading_source from = source_of(reader);
	char path[RB_ABOUT_PATH_SIZE];

	for (int i = 0; i < reader->reading.result_count; i++)
		reader->result_values[i] = rb_reading_number(
			&from, rb_about_result_path(reader->reading.result_names[i], path));
}

static enum rb_status read_changing(struct rb_reader *reader, struct rb_error *err)
{
	static const char *const paths[] = {"/rbsim/status", "/rbsim/reason", "/rbsim/state_hash",
	                                    "/rbsim/ended"};
	char **const texts[] = {&reader->status, &reader->reason, &reader->state_hash,
	                        &reader->ended};

	for (int i = 0; i < 4; i++) {
		if (!*texts[i])
			*texts[i] = rb_input_text(&reader->input, paths[i], &reader->arena,
			                          &reader->room[i]);
		else
			(void)rb_input_text_again(&reader->input, paths[i], *texts[i],
			                          reader->room[i]);
		if (!*texts[i])
			return rb_input_no_text(&reader->input, paths[i], reader->path, err);
	}
	read_results(reader);
	reader->reading.status = reader->status;
	reader->reading.reason = reader->reason;
	reader->reading.state_hash = reader->state_hash;
	reader->reading.ended = reader->ended;
	return RB_OK;
}

/* Opens what grows; a column that is there must be of the right shape. */
static enum rb_status open_column(struct rb_reader *reader, struct column *column, const char *path,
                                  struct rb_error *err)
{
	column->dataset = -1;
	column->row_bytes = rb_h5_size(column->kind);
	for (int i = 0; i < column->row.rank; i++)
		column->row_bytes *= column->row.size[i];
	if (!rb_input_has(&reader->input, path))
		return RB_OK;
	column->dataset = rb_input_dataset(&reader->input, path, true, &column->row, &column->rows);
	if (column->dataset < 0)
		return RB_FAIL(
			err, RB_ERR_INPUT,
			"'%s' in '%s' is damaged: its shape or type is not that of a recording",
			path, reader->path);
	return RB_OK;
}

static enum rb_status open_table(struct rb_reader *reader, struct table *table,
                                 const struct rb_table_cell *cells, int count, struct rb_error *err)
{
	for (int i = 0; i < count; i++) {
		struct column *const cell = &table->cells[i];
		*cell = (struct column){.kind = cells[i].kind,
		                        .row = {cells[i].width > 1, {(hsize_t)cells[i].width}}};
		const enum rb_status status = open_column(reader, cell, cells[i].path, err);
		if (status)
			return status;
		if (cell->dataset < 0)
			return RB_FAIL(err, RB_ERR_INPUT, "'%s' is missing in '%s'", cells[i].path,
			               reader->path);
	}
	table->count = count;
	return RB_OK;
}

/* Which results and probes the scene has; opens the latter. */
static enum rb_status open_measures(struct rb_reader *reader, struct rb_error *err)
{
	static const char probes[] = "/observables/probes";
	const struct rb_reading_source from = source_of(reader);
	struct rb_reading *const reading = &reader->reading;
	enum rb_status status = RB_OK;
	char path[PATH_SIZE];

	const int results = rb_reading_measures(&from, "/results", "", &reading->result_names,
	                                        &reading->result_units);
	const int count = rb_reading_measures(&from, probes, "/value", &reading->probe_names,
	                                      &reading->probe_units);
	if (!reading->result_units || !reading->probe_units)
		return no_memory(reader, err);
	for (int i = 0; i < count && !status; i++) {
		struct column *const column = &reader->probes[i];

		snprintf(path, sizeof path, "%s/%s/value", probes, reading->probe_names[i]);
		status = open_column(reader, column, path, err);
		if (!status && column->dataset < 0)
			status = RB_FAIL(err, RB_ERR_INPUT, "'%s' is missing in '%s'", path,
			                 reader->path);
		reading->probe_count = i + (column->dataset >= 0);
	}
	for (int i = 0; i < results; i++)
		rb_h5_unescape((char *)(uintptr_t)reading->result_names[i]); /* in the arena */
	for (int i = 0; i < count; i++)
		rb_h5_unescape((char *)(uintptr_t)reading->probe_names[i]);
	reading->result_count = results;
	reading->results = reader->result_values;
	read_results(reader);
	return status;
}

static enum rb_status open_sources(struct rb_reader *reader, struct rb_error *err)
{
	const struct rb_frames_source *const sources = rb_frames_sources();
	const hsize_t bodies = (hsize_t)reader->reading.body_count;
	const hsize_t joints = (hsize_t)reader->reading.joint_count;
	char path[RB_FRAMES_PATH_SIZE];
	enum rb_status status = RB_OK;

	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT && status == RB_OK; i++) {
		struct column *const column = &reader->sources[i];
		column->kind = sources[i].kind;
		column->row = rb_frames_shape(&sources[i], bodies, joints);
		if (sources[i].field != 0 &&
		    (sources[i].field == RB_FIELD_JOINTS ? joints == 0 : bodies == 0))
			continue;
		snprintf(path, sizeof path, "%s/value", sources[i].path);
		status = open_column(reader, column, path, err);
		if (status || column->dataset < 0)
			continue;
		reader->reading.fields |= sources[i].field;
		if (reader->step.dataset >= 0)
			continue;
		snprintf(path, sizeof path, "%s/step", sources[i].path);
		status = open_column(reader, &reader->step, path, err);
		snprintf(path, sizeof path, "%s/time", sources[i].path);
		if (status == RB_OK)
			status = open_column(reader, &reader->time, path, err);
	}
	return status;
}

static enum rb_status open_columns(struct rb_reader *reader, struct rb_error *err)
{
	reader->step.kind = RB_H5_I64;
	enum rb_status status = open_sources(reader, err);
	if (status)
		return status;
	if (reader->step.dataset < 0 || reader->time.dataset < 0)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "'%s' is not a recording of rbsim: it has no steps and times",
		               reader->path);

	reader->event_end.kind = reader->contact_end.kind = RB_H5_U64;
	status = open_column(reader, &reader->event_end, "/rbsim/frames/event_end", err);
	if (status == RB_OK && reader->event_end.dataset >= 0) {
		reader->reading.fields |= RB_FIELD_EVENTS;
		const bool joined = reader->reading.joint_count > 0;

		status = open_table(reader, &reader->events, rb_event_cells(),
		                    RB_EVENT_CELL_COUNT - !joined, err);
	}
	if (status == RB_OK)
		status = open_column(reader, &reader->contact_end, "/rbsim/frames/contact_end",
		                     err);
	if (status == RB_OK && reader->contact_end.dataset >= 0) {
		reader->reading.fields |= RB_FIELD_CONTACTS;
		status = open_table(reader, &reader->contacts, rb_contact_cells(),
		                    RB_CONTACT_CELL_COUNT, err);
	}
	return status;
}

/* All columns of a frame, for what is done to each. */
static int frame_columns(struct rb_reader *reader, struct column *list[COLUMNS_MAX])
{
	struct column *const others[] = {&reader->event_end, &reader->contact_end, &reader->time,
	                                 &reader->step};
	int count = 0;

	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT; i++)
		if (reader->sources[i].dataset >= 0)
			list[count++] = &reader->sources[i];
	for (int i = 0; i < reader->reading.probe_count; i++)
		list[count++] = &reader->probes[i];
	for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
		if (others[i]->dataset >= 0)
			list[count++] = others[i];
	return count;
}

static bool read_end(const struct column *column, hsize_t row, uint64_t *end)
{
	return rb_input_rows(column->dataset, RB_H5_U64, column->row, (const hsize_t[]){row, 1},
	                     end);
}

/* Frames whose rows of the table are all there: ends only grow, so halving finds them. */
static hsize_t covered(const struct column *ends, const struct table *table, hsize_t frames)
{
	hsize_t low = 0, high = frames;

	if (table->count == 0)
		return frames;
	while (low < high) {
		const hsize_t middle = high - (high - low) / 2; /* count of frames to try, > low */
		uint64_t end;
		if (read_end(ends, middle - 1, &end) && end <= table->rows)
			low = middle;
		else
			high = middle - 1;
	}
	return low;
}

/* A killed writer may leave columns of different length: what all of them have counts. */
static void count_frames(struct rb_reader *reader)
{
	struct column *list[COLUMNS_MAX];
	const int count = frame_columns(reader, list);
	hsize_t frames = HSIZE_UNDEF;

	for (int i = 0; i < count; i++)
		frames = list[i]->rows < frames ? list[i]->rows : frames;
	struct table *const tables[] = {&reader->events, &reader->contacts};
	for (int k = 0; k < 2; k++) {
		tables[k]->rows = HSIZE_UNDEF;
		for (int i = 0; i < tables[k]->count; i++)
			if (tables[k]->cells[i].rows < tables[k]->rows)
				tables[k]->rows = tables[k]->cells[i].rows;
	}
	frames = covered(&reader->event_end, &reader->events, frames);
	frames = covered(&reader->contact_end, &reader->contacts, frames);
	reader->reading.frame_count = frames;
	reader->reading.event_count = 0;
	uint64_t end;
	if (reader->events.count > 0 && frames > 0 &&
	    read_end(&reader->event_end, frames - 1, &end))
		reader->reading.event_count = end;
}

static enum rb_status take_blocks(struct rb_reader *reader, struct rb_error *err)
{
	struct column *list[COLUMNS_MAX];
	const int count = frame_columns(reader, list);
	double bytes = 1;

	for (int i = 0; i < count; i++)
		bytes += (double)list[i]->row_bytes;
	reader->block_rows = bytes > block_bytes ? 1 : (hsize_t)(block_bytes / bytes);
	for (int i = 0; i < count; i++) {
		list[i]->block = rb_memory_take(reader->block_rows, list[i]->row_bytes);
		if (!list[i]->block)
			return no_memory(reader, err);
	}
	return RB_OK;
}

static void forget_columns(struct rb_reader *reader)
{
	struct column *const singles[] = {&reader->step, &reader->time, &reader->event_end,
	                                  &reader->contact_end};

	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT; i++)
		reader->sources[i].dataset = -1;
	for (int i = 0; i < RB_MEASURES_MAX; i++)
		reader->probes[i].dataset = -1;
	for (int i = 0; i < 4; i++)
		singles[i]->dataset = -1;
	for (int i = 0; i < RB_TABLE_COLUMNS_MAX; i++)
		reader->events.cells[i].dataset = reader->contacts.cells[i].dataset = -1;
}

static enum rb_status open_recording(struct rb_reader *reader, struct rb_error *err)
{
	const struct rb_reading_source from = source_of(reader);
	enum rb_status status = rb_input_open(&reader->input, reader->path, err);
	if (status)
		return status;
	reader->reading.version = rb_input_text(&reader->input, "/rbsim/version", &reader->arena,
	                                        NULL);
	if (!reader->reading.version && rb_input_has(&reader->input, "/points/state_hash"))
		return RB_FAIL(err, RB_ERR_INPUT,
		               "'%s' is the table of a sweep, not a recording: its runs are beside "
		               "it, rbsim plot draws its columns",
		               reader->path);
	if (!reader->reading.version)
		return rb_input_no_text(&reader->input, "/rbsim/version", reader->path, err);
	status = read_changing(reader, err);
	if (status == RB_OK)
		status = rb_reading_bodies(&from, err);
	if (!status)
		status = rb_reading_forces(&from, err);
	if (!status)
		status = rb_reading_joints(&from, err);
	if (status == RB_OK)
		status = open_columns(reader, err);
	if (status == RB_OK)
		status = open_measures(reader, err);
	if (status == RB_OK)
		status = take_blocks(reader, err);
	if (status)
		return status;
	count_frames(reader);
	rb_reading_run(&from);
	status = rb_reading_params(&from, err);
	return status ? status : rb_reading_files(&from, err);
}

enum rb_status rb_reader_open(struct rb_reader **reader, const char *path, struct rb_error *err)
{
	*reader = NULL;
	struct rb_reader *const made = rb_memory_take(1, sizeof *made);
	if (!made)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", path);
	made->input = (struct rb_input){.file = -1, .fd = -1};
	forget_columns(made);
	made->path = rb_memory_copy_text(path);
	if (!made->path) {
		rb_memory_free(made);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", path);
	}
	const enum rb_status status = open_recording(made, err);
	if (status) {
		rb_reader_close(made);
		return status;
	}
	*reader = made;
	return RB_OK;
}

static void close_column(struct column *column)
{
	rb_h5_done(column->dataset);
	rb_memory_free(column->block);
	*column = (struct column){.dataset = -1};
}

void rb_reader_close(struct rb_reader *reader)
{
	if (!reader)
		return;
	struct column *const singles[] = {&reader->step, &reader->time, &reader->event_end,
	                                  &reader->contact_end};
	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT; i++)
		close_column(&reader->sources[i]);
	for (int i = 0; i < RB_MEASURES_MAX; i++)
		close_column(&reader->probes[i]);
	for (int i = 0; i < 4; i++)
		close_column(singles[i]);
	struct table *const tables[] = {&reader->events, &reader->contacts};
	for (int k = 0; k < 2; k++) {
		for (int i = 0; i < RB_TABLE_COLUMNS_MAX; i++)
			close_column(&tables[k]->cells[i]);
		rb_memory_free(tables[k]->rows_out);
		rb_memory_free(tables[k]->cells_out);
	}
	rb_input_close(&reader->input);
	rb_arena_release(&reader->arena);
	rb_memory_free(reader->path);
	rb_memory_free(reader);
}

const struct rb_reading *rb_reader_reading(const struct rb_reader *reader)
{
	return &reader->reading;
}

/* The length of a column that may have grown. */
static bool look_again(struct column *column)
{
	hsize_t size[H5S_MAX_RANK];

	if (column->dataset < 0)
		return true;
	if (H5Drefresh(column->dataset) < 0)
		return false;
	const hid_t space = H5Dget_space(column->dataset);
	const bool known = space >= 0 &&
	                   H5Sget_simple_extent_ndims(space) == column->row.rank + 1 &&
	                   H5Sget_simple_extent_dims(space, size, NULL) > 0;
	if (known)
		column->rows = size[0];
	rb_h5_done(space);
	return known;
}

enum rb_status rb_reader_refresh(struct rb_reader *reader, struct rb_error *err)
{
	struct column *list[COLUMNS_MAX];
	bool good = true;

	if (!reader->input.shared)
		return RB_OK;
	rb_h5_quiet();
	rb_input_look(&reader->input);
	const int count = frame_columns(reader, list);
	for (int i = 0; i < count; i++)
		good = look_again(list[i]) && good;
	struct table *const tables[] = {&reader->events, &reader->contacts};
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < tables[k]->count; i++)
			good = look_again(&tables[k]->cells[i]) && good;
	if (!good)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "cannot read '%s' any more: it was changed or cut off",
		               reader->path);
	count_frames(reader);
	reader->block_count = 0;
	return read_changing(reader, err);
}

static enum rb_status load_block(struct rb_reader *reader, uint64_t row, struct rb_error *err)
{
	struct column *list[COLUMNS_MAX];
	const int count = frame_columns(reader, list);
	const hsize_t first = row - row % reader->block_rows;
	const hsize_t left = reader->reading.frame_count - first;
	const hsize_t range[2] = {first, left < reader->block_rows ? left : reader->block_rows};

	reader->block_count = 0;
	for (int i = 0; i < count; i++)
		if (!rb_input_rows(list[i]->dataset, list[i]->kind, list[i]->row, range,
		                   list[i]->block)) {
			char reason[160];
			return RB_FAIL(err, RB_ERR_INPUT,
			               "cannot read frames %llu to %llu of '%s': %s",
			               (unsigned long long)range[0],
			               (unsigned long long)(range[0] + range[1] - 1), reader->path,
			               rb_h5_reason(reason));
		}
	reader->block_first = range[0];
	reader->block_count = range[1];
	return RB_OK;
}

static unsigned char *row_of(const struct rb_reader *reader, const struct column *column,
                             uint64_t row)
{
	return column->block + (row - reader->block_first) * column->row_bytes;
}

/* The rows of a table that belong to one frame. */
struct wanted {
	const struct rb_table_cell *cells;
	const struct column *ends;
	size_t row_size;
	uint64_t row;
};

/* As structs in table->rows_out. */
static enum rb_status read_rows(struct rb_reader *reader, struct table *table,
                                const struct wanted *wanted, int *count, struct rb_error *err)
{
	uint64_t begin = 0, end;

	*count = 0;
	if (table->count == 0)
		return RB_OK;
	memcpy(&end, row_of(reader, wanted->ends, wanted->row), sizeof end);
	if (wanted->row > reader->block_first)
		memcpy(&begin, row_of(reader, wanted->ends, wanted->row - 1), sizeof begin);
	else if (wanted->row > 0 && !read_end(wanted->ends, wanted->row - 1, &begin))
		end = 0; /* told below */
	if (begin > end || end > table->rows || end - begin > INT32_MAX / 2)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "'%s' in '%s' is damaged: frame %llu has rows %llu to %llu of %llu",
		               wanted->cells[0].path, reader->path, (unsigned long long)wanted->row,
		               (unsigned long long)begin, (unsigned long long)end,
		               (unsigned long long)table->rows);
	const hsize_t range[2] = {begin, end - begin};
	const size_t rows = (size_t)(end - begin);
	if (!rb_memory_reserve(&table->rows_out, &table->rows_capacity, rows * wanted->row_size + 1,
	                       1) ||
	    !rb_memory_reserve(&table->cells_out, &table->cells_capacity,
	                       rows * 3 * sizeof(double) + 1, 1))
		return no_memory(reader, err);
	/* cells that are not in every recording */
	memset(table->rows_out, 0, rows * wanted->row_size);
	for (int i = 0; i < table->count; i++) {
		const struct rb_table_cell *const cell = &wanted->cells[i];
		const size_t bytes = table->cells[i].row_bytes;
		if (!rb_input_rows(table->cells[i].dataset, cell->kind, table->cells[i].row, range,
		                   table->cells_out))
			return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s' in '%s'", cell->path,
			               reader->path);
		for (size_t k = 0; k < rows; k++)
			memcpy(table->rows_out + k * wanted->row_size + cell->offset,
			       table->cells_out + k * bytes, bytes);
	}
	*count = (int)rows;
	return RB_OK;
}

/* Events and contacts: into memory of the reader's that has the frame's types. */
static enum rb_status fill_rows(struct rb_reader *reader, uint64_t row, struct rb_frame *frame,
                                struct rb_error *err)
{
	const struct wanted events = {rb_event_cells(), &reader->event_end, sizeof(struct rb_event),
	                              row};
	const struct wanted contacts = {rb_contact_cells(), &reader->contact_end,
	                                sizeof(struct rb_contact_row), row};

	enum rb_status status = read_rows(reader, &reader->events, &events, &frame->event_count,
	                                  err);
	if (status == RB_OK)
		status = read_rows(reader, &reader->contacts, &contacts, &frame->contact_count,
		                   err);
	if (status)
		return status;
	if (frame->event_count > 0)
		frame->events = (struct rb_event *)(void *)reader->events.rows_out;
	const int bodies = reader->reading.body_count + reader->reading.static_count;
	for (int i = 0; i < frame->event_count; i++) {
		const struct rb_event *const e = &frame->events[i];
		if ((unsigned)e->kind >= RB_EVENT_KIND_COUNT || e->a < 0 || e->a >= bodies ||
		    e->b < 0 || e->b >= bodies || e->joint < 0 ||
		    e->joint > reader->reading.joint_count)
			return RB_FAIL(err, RB_ERR_INPUT,
			               "'/rbsim/events' in '%s' is damaged: frame %llu has kind %d "
			               "of bodies %d and %d",
			               reader->path, (unsigned long long)row, (int)e->kind, e->a,
			               e->b);
	}
	frame->event_capacity = frame->event_count;
	if (frame->contact_count > 0) {
		/* without their steps, in place: a row is longer than what is left of it */
		struct rb_frame_contact *const packed = (struct rb_frame_contact *)(void *)
		                                                reader->contacts.rows_out;
		for (int i = 0; i < frame->contact_count; i++) {
			struct rb_contact_row contact;
			memcpy(&contact, reader->contacts.rows_out + (size_t)i * sizeof contact,
			       sizeof contact);
			packed[i] = contact.contact;
		}
		frame->contacts = packed;
	}
	frame->contact_capacity = frame->contact_count;
	return RB_OK;
}

enum rb_status rb_reader_frame(struct rb_reader *reader, uint64_t row, struct rb_frame *frame,
                               struct rb_error *err)
{
	const struct rb_frames_source *const sources = rb_frames_sources();
	int64_t step;

	*frame = (struct rb_frame){0};
	if (row >= reader->reading.frame_count)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' has no frame %llu: it has %llu",
		               reader->path, (unsigned long long)row,
		               (unsigned long long)reader->reading.frame_count);
	rb_h5_quiet();
	if (row < reader->block_first || row - reader->block_first >= reader->block_count) {
		const enum rb_status status = load_block(reader, row, err);
		if (status)
			return status;
	}
	memcpy(&step, row_of(reader, &reader->step, row), sizeof step);
	memcpy(&frame->time_s, row_of(reader, &reader->time, row), sizeof frame->time_s);
	frame->index = (uint64_t)step;
	frame->body_count = reader->reading.body_count;
	frame->joint_count = reader->reading.joint_count;
	frame->has_events = reader->reading.fields & RB_FIELD_EVENTS;
	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT; i++) {
		if (reader->sources[i].dataset < 0)
			continue;
		unsigned char *const at = row_of(reader, &reader->sources[i], row);
		if (sources[i].field != 0) {
			double *const column = (double *)(void *)at;
			memcpy((unsigned char *)frame + sources[i].offset, &column, sizeof column);
		} else {
			memcpy((unsigned char *)&frame->numbers + sources[i].offset, at,
			       reader->sources[i].row_bytes);
			frame->numbers.has_ledger |= sources[i].where == RB_FRAMES_LEDGER;
		}
	}
	for (int i = 0; i < reader->reading.probe_count; i++)
		memcpy(&reader->probe_values[i], row_of(reader, &reader->probes[i], row),
		       sizeof(double));
	frame->probe_count = reader->reading.probe_count;
	frame->probes = frame->probe_count > 0 ? reader->probe_values : NULL;
	const enum rb_status status = fill_rows(reader, row, frame, err);
	if (status)
		*frame = (struct rb_frame){0};
	return status;
}

/* The whole of a column of numbers, as doubles. */
static enum rb_status read_whole(struct rb_reader *reader, const struct column *column,
                                 const char *name, double *values, struct rb_error *err)
{
	const hsize_t range[2] = {0, reader->reading.frame_count};

	if (!rb_input_rows(column->dataset, RB_H5_F64, column->row, range, values))
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s' in '%s'", name, reader->path);
	return RB_OK;
}

enum rb_status rb_reader_observable(struct rb_reader *reader, const char *name, int width,
                                    double *values, struct rb_error *err)
{
	static const char folder[] = "/observables/";
	const struct rb_frames_source *const sources = rb_frames_sources();

	rb_h5_quiet();
	if (strcmp(name, "time") == 0 && width == 1)
		return read_whole(reader, &reader->time, name, values, err);
	for (int i = 0; i < reader->reading.probe_count && width == 1; i++)
		if (strncmp(name, "probes/", 7) == 0 &&
		    strcmp(reader->reading.probe_names[i], name + 7) == 0)
			return read_whole(reader, &reader->probes[i], name, values, err);
	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT; i++) {
		if (sources[i].field != 0 || strcmp(sources[i].path + strlen(folder), name) != 0)
			continue;
		if (sources[i].width != width || sources[i].rows > 0)
			break;
		if (reader->sources[i].dataset >= 0)
			return read_whole(reader, &reader->sources[i], name, values, err);
		break;
	}
	return RB_FAIL(err, RB_ERR_INPUT, "'%s' has no observable '%s' of width %d", reader->path,
	               name, width);
}

const char *rb_reader_units(const struct rb_reader *reader, const char *name)
{
	static const char folder[] = "/observables/";
	const struct rb_frames_source *const sources = rb_frames_sources();

	for (int i = 0; i < reader->reading.probe_count; i++)
		if (strncmp(name, "probes/", 7) == 0 &&
		    strcmp(reader->reading.probe_names[i], name + 7) == 0)
			return reader->reading.probe_units[i];
	for (int i = 0; i < RB_FRAMES_SOURCE_COUNT; i++)
		if (sources[i].field == 0 && sources[i].units &&
		    strcmp(sources[i].path + strlen(folder), name) == 0)
			return sources[i].units;
	return strcmp(name, "time") == 0 ? "s" : "";
}
