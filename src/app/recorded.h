/* SPDX-License-Identifier: MIT */
/*
 * The scene that a recording was made from, loaded again: from the files, the parameters and the
 * numbers that the recording holds. Nothing beside the recording is read.
 */
#ifndef RB_APP_RECORDED_H
#define RB_APP_RECORDED_H

#include "app/common.h"
#include "sink/module.h"

/*
 * Opens a recording that holds a frame; the caller closes `*reader` unless it is NULL.
 * RB_ERR_INPUT: it is none, or holds no frame.
 */
RB_CHECKED enum rb_status rb_recorded_open(const struct rb_hdf5_module **module,
                                           struct rb_reader **reader, const char *path,
                                           struct rb_error *err);

/*
 * `loaded` is released with rb_loaded_release in any case. RB_ERR_INPUT when the stored scene does
 * not load or gives other bodies than those that were recorded.
 */
RB_CHECKED enum rb_status rb_recorded_load(struct rb_loaded *loaded,
                                           const struct rb_reading *reading, const char *path,
                                           bool trust, struct rb_error *err);

/*
 * The last row of a recording whose frame is not after a time (or a number, for the other), row 0
 * when all are. The recording has at least one row.
 */
RB_CHECKED enum rb_status rb_recorded_row_at(const struct rb_hdf5_module *module,
                                             struct rb_reader *reader, double time_s, uint64_t *row,
                                             struct rb_error *err);
RB_CHECKED enum rb_status rb_recorded_row_of(const struct rb_hdf5_module *module,
                                             struct rb_reader *reader, uint64_t frame,
                                             uint64_t *row, struct rb_error *err);

#endif
