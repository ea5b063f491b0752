/* SPDX-License-Identifier: MIT */
/*
 * HDF5 -> the same frames, from a recording that is complete, still grows, or was cut off.
 *
 * A reader belongs to one thread. The file is not trusted: rank, type, layout and size of
 * everything are checked before it is read, links out of the file are not followed, and nothing is
 * allocated that the file's size does not cover.
 */
#ifndef RB_SINK_READER_H
#define RB_SINK_READER_H

#include "sink/module.h"

RB_CHECKED enum rb_status rb_reader_open(struct rb_reader **reader, const char *path,
                                         struct rb_error *err);
void rb_reader_close(struct rb_reader *reader); /* NULL is fine */
const struct rb_reading *rb_reader_reading(const struct rb_reader *reader);
RB_CHECKED enum rb_status rb_reader_refresh(struct rb_reader *reader, struct rb_error *err);
RB_CHECKED enum rb_status rb_reader_frame(struct rb_reader *reader, uint64_t row,
                                          struct rb_frame *frame, struct rb_error *err);
RB_CHECKED enum rb_status rb_reader_observable(struct rb_reader *reader, const char *name,
                                               int width, double *values, struct rb_error *err);

const char *rb_reader_units(const struct rb_reader *reader, const char *name);

#endif
