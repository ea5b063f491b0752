/* SPDX-License-Identifier: MIT */
/*
 * A dataset that grows by rows, [rows][...], and where its chunks go.
 *
 * Owned by the thread that owns the file. Chunks without a filter are kept out of the library's
 * cache: rows go to the file when they are appended, part of a chunk as well as a whole one, and
 * nothing but the index waits for a flush.
 */
#ifndef RB_SINK_H5COLUMN_H
#define RB_SINK_H5COLUMN_H

#include "sink/h5file.h"

/* How a column is laid out. */
struct rb_h5_layout {
	enum rb_h5_kind kind;
	rb_h5_shape row; /* of one row; its sizes may be split among chunks along the first axis */
	hsize_t chunk_rows;
	hsize_t chunk_first; /* how much of row.size[0] one chunk holds; 0: all */
	int compression;     /* 0: no filter */
};

struct rb_h5_column {
	hid_t dataset, type;
	struct rb_h5_layout layout;
	hsize_t rows; /* on disk, as far as they are ours */
	/* of a file that was there: rows that it has, which are written over, never cut off */
	hsize_t there;
	size_t row_bytes;
	const char *path; /* borrowed, for messages */
};

/* `path` must live as long as the column. */
void rb_h5_column_create(struct rb_h5 *h5, struct rb_h5_column *column, const char *path,
                         const struct rb_h5_layout *layout);
/* Closes the dataset, and opens it again: it must be closed when the file is switched to SWMR. */
void rb_h5_column_detach(struct rb_h5_column *column);
void rb_h5_column_attach(struct rb_h5 *h5, struct rb_h5_column *column);
void rb_h5_column_append(struct rb_h5 *h5, struct rb_h5_column *column, hsize_t count,
                         const void *data);
/* Grows the dataset without writing: for estimates. */
void rb_h5_column_extend(struct rb_h5 *h5, struct rb_h5_column *column, hsize_t count);
void rb_h5_column_close(struct rb_h5_column *column); /* safe on a zeroed one */

/* Most bytes of the file that `count` rows more can take, the index's included. */
uint64_t rb_h5_column_need(const struct rb_h5_column *column, hsize_t count);
/* Bytes that `rows` rows take in the end, the chunks as they are without a filter. */
uint64_t rb_h5_column_bytes(const struct rb_h5_column *column, hsize_t rows);
/* Bytes of the rows alone, without a filter. */
uint64_t rb_h5_column_plain(const struct rb_h5_column *column, hsize_t rows);

#endif
