/* SPDX-License-Identifier: MIT */
#include "sink/h5rows.h"

#include "base/error.h"
#include "base/memory.h"

#include <string.h>

/* Rows of events and contacts that wait at most. */
enum { TABLE_ROWS_MAX = 65536 };

/* Committed rows in the buffer of a column. */
static hsize_t waiting(const struct rb_frames *frames, const struct rb_frames_column *column)
{
	return column->of_bodies ? frames->bodies_count : frames->count;
}

/* The next row of a buffer. */
static void *row_of(const struct rb_frames *frames, const struct rb_frames_column *column)
{
	const hsize_t row = waiting(frames, column);

	RB_ASSERT(column->buffer &&
	          row < (column->of_bodies ? frames->capacity : frames->numbers_capacity));
	return column->buffer + row * column->column.row_bytes;
}

/* A column of bodies in a frame; NULL: it is not there. */
static const double *column_of(const struct rb_frames_column *column, const struct rb_frame *frame)
{
	const double *from;

	memcpy(&from, (const unsigned char *)frame + column->source->offset, sizeof from);
	return from;
}

/* Copies a column of a frame, unless that is kept. */
static enum rb_status copy_bodies(const struct rb_frames *frames, struct rb_frames_column *column,
                                  const struct rb_frame *frame, struct rb_error *err)
{
	const double *const from = column_of(column, frame);

	if (!from || frame->body_count != frames->model->body_count ||
	    frame->joint_count != frames->model->scene->joint_count)
		return RB_FAIL(err, RB_ERR_BUG, "frame %llu has no column for '%s'",
		               (unsigned long long)frame->index, column->path);
	if (frames->kept)
		return RB_OK;
	void *const to = row_of(frames, column);
	if (column->column.layout.kind == RB_H5_F64) {
		memcpy(to, from, column->column.row_bytes);
	} else {
		const size_t count = column->column.row_bytes / sizeof(float);
		float *const single = to;
		for (size_t i = 0; i < count; i++)
			single[i] = (float)from[i];
	}
	return RB_OK;
}

/* Copies a probe of a frame. */
static enum rb_status copy_probe(const struct rb_frames *frames, struct rb_frames_column *column,
                                 const struct rb_frame *frame, struct rb_error *err)
{
	if (!frame->probes || column->probe >= frame->probe_count)
		return RB_FAIL(err, RB_ERR_BUG, "frame %llu has no number for '%s'",
		               (unsigned long long)frame->index, column->path);
	memcpy(row_of(frames, column), &frame->probes[column->probe], sizeof(double));
	return RB_OK;
}

/*
 * Counts of the frames left out are added to those of the next one recorded; moments are that
 * frame's own.
 */
static void join_numbers(struct rb_frames *frames, const struct rb_frame_numbers *numbers)
{
	const struct rb_frame_numbers before = frames->since;

	frames->since = *numbers;
	if (frames->has_since) {
		frames->since.collisions += before.collisions;
		frames->since.rollbacks += before.rollbacks;
		frames->since.substeps += before.substeps;
		frames->since.stepped += before.stepped;
		if (before.smallest_step > 0 && !(numbers->smallest_step <= before.smallest_step))
			frames->since.smallest_step = before.smallest_step;
	}
	frames->has_since = true;
}

/* Appends the events and contacts of a frame to the waiting rows. */
static enum rb_status keep_rows(struct rb_frames *frames, const struct rb_frame *frame,
                                struct rb_error *err)
{
	struct rb_frames_table *const events = &frames->events, *const contacts = &frames->contacts;
	bool kept = true;

	RB_ASSERT(frames->contacts.committed <= frames->contacts.count);
	if (events->on && frame->event_count > 0) {
		const size_t count = (size_t)frame->event_count;
		kept = rb_memory_reserve(&events->rows, &events->capacity, events->count + count,
		                         events->row_size);
		if (kept)
			memcpy(events->rows + events->count * events->row_size, frame->events,
			       count * events->row_size);
		events->count += kept ? count : 0;
	}
	contacts->count = contacts->committed; /* those of a frame that was left out go */
	if (kept && contacts->on && frame->contact_count > 0) {
		const size_t count = (size_t)frame->contact_count;
		kept = rb_memory_reserve(&contacts->rows, &contacts->capacity,
		                         contacts->count + count, contacts->row_size);
		for (size_t i = 0; kept && i < count; i++) {
			const struct rb_contact_row row = {(int64_t)frame->index,
			                                   frame->contacts[i]};
			memcpy(contacts->rows + (contacts->count + i) * sizeof row, &row,
			       sizeof row);
		}
		contacts->count += kept ? count : 0;
	}
	return kept ? RB_OK
	            : RB_FAIL(err, RB_ERR_MEMORY,
	                      "cannot buffer the contacts of a frame: out of memory");
}

enum rb_status rb_frames_take(struct rb_frames *frames, const struct rb_frame *frame,
                              struct rb_error *err)
{
	RB_ASSERT(frames->bodies_count < frames->capacity &&
	          frames->count < frames->numbers_capacity);
	join_numbers(frames, &frame->numbers);
	enum rb_status status = keep_rows(frames, frame, err);

	for (int i = 0; i < frames->column_count && status == RB_OK; i++) {
		struct rb_frames_column *const column = &frames->columns[i];
		if (column->of_probe)
			status = copy_probe(frames, column, frame, err);
		if (!column->source)
			continue;
		if (column->of_bodies)
			status = copy_bodies(frames, column, frame, err);
		else
			memcpy(row_of(frames, column),
			       (const unsigned char *)&frames->since + column->source->offset,
			       column->column.row_bytes);
	}
	if (status)
		return status;

	const uint64_t event_end = frames->events.rows_written + frames->events.count;
	const uint64_t contact_end = frames->contacts.rows_written + frames->contacts.count;
	if (frames->event_end)
		memcpy(row_of(frames, frames->event_end), &event_end, sizeof event_end);
	if (frames->contact_end)
		memcpy(row_of(frames, frames->contact_end), &contact_end, sizeof contact_end);
	memcpy(row_of(frames, frames->time), &frame->time_s, sizeof frame->time_s);
	memcpy(row_of(frames, frames->step), &(int64_t){(int64_t)frame->index}, sizeof(int64_t));
	frames->pending = true;
	if (frames->kept)
		frames->kept[frames->bodies_count] = frame;
	if (frame->index % frames->every == 0 || frame->index + 1 == frames->model->frame_count)
		rb_frames_commit(frames);
	return RB_OK;
}

void rb_frames_commit(struct rb_frames *frames)
{
	if (!frames->pending)
		return;
	frames->pending = false;
	frames->count++;
	frames->bodies_count++;
	RB_ASSERT(frames->bodies_count <= frames->count);
	frames->events.committed = frames->events.count;
	frames->contacts.committed = frames->contacts.count;
	frames->has_since = false;
}

/* Buffers end where chunks end, whatever was written of them before their time. */
bool rb_frames_full(const struct rb_frames *frames)
{
	const hsize_t end = frames->bodies_written + frames->bodies_count;
	const hsize_t whole = frames->capacity > frames->chunk_rows ? frames->capacity
	                                                            : frames->chunk_rows;

	return frames->bodies_count == frames->capacity ||
	       (frames->bodies_count > 0 && end % whole == 0);
}

bool rb_frames_due(const struct rb_frames *frames)
{
	return frames->count >= frames->numbers_capacity ||
	       frames->events.committed + frames->contacts.committed > TABLE_ROWS_MAX;
}

uint64_t rb_frames_need(const struct rb_frames *frames)
{
	uint64_t bytes = 0;

	for (int i = 0; i < frames->events.column_count; i++)
		bytes += rb_h5_column_need(&frames->events.columns[i], frames->events.committed);
	for (int i = 0; i < frames->contacts.column_count; i++)
		bytes += rb_h5_column_need(&frames->contacts.columns[i],
		                           frames->contacts.committed);
	for (int i = 0; i < frames->column_count; i++)
		bytes += rb_h5_column_need(&frames->columns[i].column,
		                           waiting(frames, &frames->columns[i]));
	return bytes;
}

/* Appends the committed rows of a table to its datasets, column by column. */
static void write_table(struct rb_h5 *h5, struct rb_frames_table *table)
{
	RB_ASSERT(table->committed <= table->count);
	if (table->committed == 0 || h5->status)
		return;
	/* as wide as the widest column: three numbers */
	const size_t wanted = table->committed * 3 * sizeof(double);
	if (!rb_memory_reserve(&table->cells_out, &table->cells_out_size, wanted, 1)) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
		                     "cannot record events: out of memory");
		return;
	}
	for (int i = 0; i < table->column_count; i++) {
		const size_t bytes = rb_h5_size(table->cells[i].kind) *
		                     (size_t)table->cells[i].width;
		for (size_t k = 0; k < table->committed; k++)
			memcpy(table->cells_out + k * bytes,
			       table->rows + k * table->row_size + table->cells[i].offset, bytes);
		rb_h5_column_append(h5, &table->columns[i], table->committed, table->cells_out);
	}
	if (h5->status)
		return;
	memmove(table->rows, table->rows + table->committed * table->row_size,
	        (table->count - table->committed) * table->row_size);
	table->count -= table->committed;
	table->rows_written += table->committed;
	table->committed = 0;
}

/* Appends a column of the kept frames: as one block where they follow one another. */
static void write_kept(struct rb_h5 *h5, const struct rb_frames *frames,
                       struct rb_frames_column *column)
{
	const size_t width = column->column.row_bytes / sizeof(double);

	for (hsize_t first = 0, next; first < frames->bodies_count; first = next) {
		const double *const from = column_of(column, frames->kept[first]);

		for (next = first + 1; next < frames->bodies_count; next++)
			if (column_of(column, frames->kept[next]) != from + (next - first) * width)
				break;
		rb_h5_column_append(h5, &column->column, next - first, from);
	}
}

/*
 * Appends so many waiting rows of all columns of bodies, or of all others in their order, and moves
 * a frame that waits to be the last to the front.
 */
static void write_columns(struct rb_h5 *h5, struct rb_frames *frames, bool of_bodies, hsize_t rows)
{
	for (int i = 0; i < frames->column_count; i++) {
		struct rb_frames_column *const column = &frames->columns[i];

		if (column->of_bodies != of_bodies)
			continue;
		if (of_bodies && frames->kept) {
			write_kept(h5, frames, column);
			continue;
		}
		rb_h5_column_append(h5, &column->column, rows, column->buffer);
		if (frames->pending && !h5->status)
			memmove(column->buffer, row_of(frames, column), column->column.row_bytes);
	}
}

int rb_frames_kept(const struct rb_frames *frames)
{
	return frames->kept ? (int)frames->bodies_count : 0;
}

void rb_frames_write_bodies(struct rb_h5 *h5, struct rb_frames *frames)
{
	write_columns(h5, frames, true, frames->bodies_count);
	if (h5->status)
		return;
	frames->bodies_written += frames->bodies_count;
	frames->bodies_count = 0;
}

void rb_frames_write(struct rb_h5 *h5, struct rb_frames *frames)
{
	write_table(h5, &frames->events);
	write_table(h5, &frames->contacts);
	rb_frames_write_bodies(h5, frames);
	/* `step` stands last: a frame is there when its step is */
	write_columns(h5, frames, false, frames->count);
	if (h5->status)
		return;
	frames->written += frames->count;
	frames->count = 0;
	RB_ASSERT(frames->written == frames->bodies_written);
}

/* Of a table only the rows of the first `rows` waiting frames count from here on. */
static void cut_table(struct rb_frames_table *table, const struct rb_frames_column *end,
                      hsize_t rows)
{
	uint64_t last;

	if (!table->on)
		return;
	memcpy(&last, end->buffer + (rows - 1) * end->column.row_bytes, sizeof last);
	table->committed = (size_t)(last - table->rows_written);
}

void rb_frames_write_rest(struct rb_h5 *h5, struct rb_frames *frames)
{
	const hsize_t rows = frames->count - frames->bodies_count;

	frames->pending = false;
	if (rows > 0) {
		cut_table(&frames->events, frames->event_end, rows);
		cut_table(&frames->contacts, frames->contact_end, rows);
		write_table(h5, &frames->events);
		write_table(h5, &frames->contacts);
		write_columns(h5, frames, false, rows);
	}
	if (!h5->status)
		frames->written += rows;
	frames->count = frames->bodies_count = 0;
}
