/* SPDX-License-Identifier: MIT */
/*
 * What of a recording grows with its frames: the columns of elements and observables, the tables of
 * events and contacts, and the buffers before them.
 *
 * A frame is copied into the next row of every buffer; it counts once it is committed. One that
 * `every` leaves out stays there uncommitted, to be overwritten by the next one or, when it was the
 * last, committed after all. Owned by one thread. Buffers are taken once; those of events and
 * contacts grow. Those of bodies and joints hold few frames, for their size; they are written
 * whenever they are full, and all the rest, which a call to the library for each column costs more
 * than its bytes, only when the file is to be flushed.
 */
#ifndef RB_SINK_H5FRAMES_H
#define RB_SINK_H5FRAMES_H

#include <rbsim/frame.h>

#include "flow/run_info.h"
#include "sink/h5column.h"

/*
 * Where a column of a frame comes from, and where it stands in the file: one table for recorder and
 * reader.
 */
enum rb_frames_where {
	RB_FRAMES_ALWAYS,
	RB_FRAMES_LEDGER, /* where the ledger is kept */
	RB_FRAMES_TREE    /* where steps would sum gravitation by a tree */
};
struct rb_frames_source {
	const char *path;  /* of the element: .../value, .../step, .../time stand below */
	const char *units; /* NULL: a pure number */
	/* RB_FIELD_*: a column of bodies, RB_FIELD_JOINTS one of joints; 0: one of the numbers */
	unsigned field;
	enum rb_h5_kind kind;
	int width;
	size_t offset; /* of the pointer in rb_frame, or of the number in rb_frame_numbers */
	int rows;      /* of a number that is a table: width 3; 0: it is none */
	enum rb_frames_where where;
};
enum { RB_FRAMES_SOURCE_COUNT = 41 };
const struct rb_frames_source *rb_frames_sources(void); /* [RB_FRAMES_SOURCE_COUNT] */

/* What a frame has of it. */
rb_h5_shape rb_frames_shape(const struct rb_frames_source *source, hsize_t bodies, hsize_t joints);

/* One column of a table: events are rows of struct rb_event, contacts of struct rb_contact_row. */
struct rb_table_cell {
	const char *path, *units;
	enum rb_h5_kind kind;
	int width;
	size_t offset;
};
struct rb_contact_row {
	int64_t step; /* of its frame */
	struct rb_frame_contact contact;
};
/* The last cell of events is there where the scene has joints. */
enum { RB_EVENT_CELL_COUNT = 9, RB_CONTACT_CELL_COUNT = 7 };
const struct rb_table_cell *rb_event_cells(void);
const struct rb_table_cell *rb_contact_cells(void);

enum { RB_FRAMES_COLUMNS_MAX = 48, RB_TABLE_COLUMNS_MAX = 10 };
/* A name of RB_MEASURE_NAME_MAX bytes, each of which may be escaped, has room. */
enum { RB_FRAMES_PATH_SIZE = 240 };

/* "/observables/probes/NAME", the name as HDF5 can hold it; written to `out`, which is returned. */
const char *rb_frames_probe_path(const char *name, char out[RB_FRAMES_PATH_SIZE]);

struct rb_frames_column {
	struct rb_h5_column column;
	const struct rb_frames_source
		*source; /* NULL: step, time and ends, which are no part of a frame's columns */
	bool of_probe;   /* the `probe`-th number of a frame's probes; it has no source */
	int probe;
	bool of_bodies;        /* or joints */
	unsigned char *buffer; /* owned, rows of its capacity; NULL: none is needed */
	char path[RB_FRAMES_PATH_SIZE];
};

/* Rows of any number to a frame. */
struct rb_frames_table {
	bool on;
	struct rb_h5_column columns[RB_TABLE_COLUMNS_MAX];
	int column_count;
	const struct rb_table_cell *cells;
	size_t row_size;
	unsigned char *rows;      /* owned: waiting, [capacity][row_size] */
	unsigned char *cells_out; /* owned: one column of them */
	size_t cells_out_size;
	size_t count, committed, capacity;
	uint64_t rows_written; /* to the file */
};

struct rb_frames {
	const struct rb_model *model; /* borrowed */
	unsigned fields;              /* RB_FIELD_*: stored per frame */
	uint64_t every;
	/*
	 * [capacity], owned: the frames whose columns of bodies wait, which are written from there;
	 * NULL: they are copied to buffers
	 */
	const struct rb_frame **kept;
	struct rb_frames_column *columns; /* owned: [RB_FRAMES_COLUMNS_MAX + probes] */
	int column_count;
	struct rb_frames_column *time, *event_end, *contact_end,
		*step; /* in columns; step is the last. NULL: there was no memory */
	struct rb_frames_table events, contacts;

	/* rows that the buffers of bodies and joints hold, and those of all else */
	hsize_t capacity, numbers_capacity;
	hsize_t chunk_rows;     /* of columns of bodies */
	hsize_t written;        /* frames in the file */
	hsize_t there;          /* frames that it had when it was opened again */
	hsize_t count;          /* committed frames in the buffers */
	hsize_t bodies_written; /* of bodies and joints: these go ahead of the rest */
	hsize_t bodies_count;
	bool pending;                  /* one more row is filled, not committed */
	struct rb_frame_numbers since; /* of the frames left out since the last one committed */
	bool has_since;
};

/* Frames that a whole run records. */
uint64_t rb_frames_expected(const struct rb_run_info *info);

/*
 * Where headers and indices of the datasets are to stand so that none of them crosses a page, in
 * bytes.
 */
unsigned rb_frames_alignment(const struct rb_run_info *info);

/*
 * Makes the datasets, without buffers: for estimates nothing is taken. Release it whatever the
 * outcome.
 */
void rb_frames_create(struct rb_h5 *h5, struct rb_frames *frames, const struct rb_run_info *info);
/*
 * Buffers. `keep_most`: frames that come and stay as they are until they are written
 * (rb_frames_kept); 0: each is read before rb_frames_take returns.
 */
void rb_frames_take_buffers(struct rb_h5 *h5, struct rb_frames *frames, int keep_most);
/*
 * In a file where all of it stands (h5->there): goes on after `rows` of its frames. What stands
 * behind them stays until it is written over. RB_ERR_INPUT where there are fewer, or row `rows` - 1
 * is not `frame`.
 */
void rb_frames_go_on(struct rb_h5 *h5, struct rb_frames *frames, hsize_t rows, uint64_t frame);
void rb_frames_release(struct rb_frames *frames); /* safe on a zeroed one */
/* Closes all datasets, and opens them again (rb_h5_column_detach). */
void rb_frames_detach(struct rb_frames *frames);
/* Leaves the datasets open for good: for a library that is not to be asked again. */
void rb_frames_forget(struct rb_frames *frames);
void rb_frames_attach(struct rb_h5 *h5, struct rb_frames *frames);

/* For estimates: the datasets as long as after `count` frames, and the bytes that the rows take. */
uint64_t rb_frames_pretend(struct rb_h5 *h5, struct rb_frames *frames, uint64_t count);
/* The bytes of that many frames without anything around them. */
uint64_t rb_frames_plain(const struct rb_frames *frames, uint64_t count);

#endif
