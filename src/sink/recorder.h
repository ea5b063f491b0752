/* SPDX-License-Identifier: MIT */
/*
 * Frames -> HDF5, the file of rbsim-recording(5).
 *
 * The recorder is made on the main thread and then belongs to the pump's thread from `open` to
 * `close`; whoever made it destroys it after the thread has ended. `info` and what it points to
 * must outlive it.
 */
#ifndef RB_SINK_RECORDER_H
#define RB_SINK_RECORDER_H

#include "sink/module.h"

RB_CHECKED enum rb_status rb_recorder_create(struct rb_recorder **recorder, struct rb_sink *sink,
                                             const struct rb_run_info *info,
                                             const struct rb_recorder_options *options,
                                             struct rb_error *err);
void rb_recorder_destroy(struct rb_recorder *recorder); /* NULL is fine */
/* Any thread, as in sink/module.h. */
void rb_recorder_ask(struct rb_recorder *recorder, uint64_t frame);
bool rb_recorder_wait(struct rb_recorder *recorder, uint64_t frame);

#endif
