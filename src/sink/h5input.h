/* SPDX-License-Identifier: MIT */
/*
 * Reading from an HDF5 file that nobody vouches for.
 *
 * Every call checks first and reads then: links within the file only, data in the file only,
 * filters that every HDF5 has, fixed-length types of the class asked for, and no more bytes than
 * the file can hold. One thread each.
 */
#ifndef RB_SINK_H5INPUT_H
#define RB_SINK_H5INPUT_H

#include "base/arena.h"
#include "sink/h5file.h"

struct rb_input {
	hid_t file;
	const char *name; /* for messages; borrowed */
	bool shared;      /* opened in SWMR mode: it may grow */
	uint64_t size_bytes;
	int fd; /* to look at the size again */
};

/* RB_ERR_INPUT. Release it whatever the outcome. */
RB_CHECKED enum rb_status rb_input_open(struct rb_input *input, const char *name,
                                        struct rb_error *err);
void rb_input_close(struct rb_input *input);
void rb_input_look(struct rb_input *input); /* at the size, again */

/* Every link on the way is one within the file, and leads to something. */
bool rb_input_has(const struct rb_input *input, const char *path);

/*
 * A dataset of numbers, [rows][row.size...] (`grows`) or of the shape `row`; -1 if it is anything
 * else. `rows` receives the first dimension. Sizes of 0 in `row` are filled in.
 */
hid_t rb_input_dataset(const struct rb_input *input, const char *path, bool grows, rb_h5_shape *row,
                       hsize_t *rows);

/* Rows of such a dataset, converted to `kind`; false when they can't be read. */
bool rb_input_rows(hid_t dataset, enum rb_h5_kind kind, rb_h5_shape row, const hsize_t range[2],
                   void *out);

/* A dataset of fixed shape in one go. */
bool rb_input_numbers(const struct rb_input *input, const char *path, enum rb_h5_kind kind,
                      rb_h5_shape shape, void *out);

/*
 * A fixed-length text, zero-terminated, in `arena`; NULL: there is none. `room` (may be NULL): its
 * length on disk.
 */
char *rb_input_text(const struct rb_input *input, const char *path, struct rb_arena *arena,
                    size_t *room);
/*
 * Why rb_input_text gave NULL for a text that the recording `name` must have: it has none there,
 * its bytes cannot be read, or memory was out.
 */
enum rb_status rb_input_no_text(const struct rb_input *input, const char *path, const char *name,
                                struct rb_error *err);
/* The same into memory that has room + 1 bytes. */
bool rb_input_text_again(const struct rb_input *input, const char *path, char *text, size_t room);
/*
 * A list of bytes (unsigned 8-bit integers), in `arena` with a zero behind them; NULL: there is
 * none.
 */
char *rb_input_bytes(const struct rb_input *input, const char *path, struct rb_arena *arena,
                     size_t *size);
/* `count` texts. */
const char **rb_input_texts(const struct rb_input *input, const char *path, size_t count,
                            struct rb_arena *arena);
/* A text that is an attribute of the object at `path`. */
char *rb_input_attribute(const struct rb_input *input, const char *path, const char *name,
                         struct rb_arena *arena);

/* Names of a group's members in the order they were made, at most `most` of them. */
int rb_input_members(const struct rb_input *input, const char *path, int most, const char ***names,
                     struct rb_arena *arena);

/* Rows of a dataset of numbers that may be missing: 0 then. */
int rb_input_row_count(const struct rb_input *input, const char *path);

#endif
