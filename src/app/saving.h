/* SPDX-License-Identifier: MIT */
/*
 * When a run is kept: every so many seconds of wall time, when a command asks, and at its end by a
 * signal.
 *
 * Owned by the simulator's thread. NULL stands for a run that is not kept, because it is not
 * recorded.
 */
#ifndef RB_APP_SAVING_H
#define RB_APP_SAVING_H

#include "app/checkpoint.h"
#include "app/common.h"
#include "flow/run_info.h"
#include "sink/module.h"

struct rb_saving;

struct rb_saving_options {
	const struct rb_loaded *loaded;
	const struct rb_run_info *info;
	const struct rb_hdf5_module *module;
	struct rb_recorder *recorder;
	double every_s;         /* wall time; 0: only when asked, NAN: the default */
	bool resumed;           /* there is a checkpoint of this run already, ... */
	uint64_t resumed_frame; /* ... of this frame */
	struct rb_checkpoint_parts parts;
};

/* All is borrowed until rb_saving_stop. */
RB_CHECKED enum rb_status rb_saving_start(struct rb_saving **made,
                                          const struct rb_saving_options *options,
                                          struct rb_error *err);
/* Waits for what is being written, and tells of all. NULL is fine, here and below. */
struct rb_checkpoints_tally rb_saving_stop(struct rb_saving *saving);

/* Whether a checkpoint can be made at this frame: the recording must have it. */
bool rb_saving_can(const struct rb_saving *saving, uint64_t frame);
/* A signal has come: whether the frame under way may take more time to come to its end. */
bool rb_saving_waits(struct rb_saving *saving);
/*
 * After a frame was published: makes a checkpoint if it is time. What goes wrong is a warning, once
 * until it goes well.
 */
void rb_saving_frame(struct rb_saving *saving, uint64_t frame);
/* The next frame that can be kept is. RB_ERR_USAGE: this run can't be kept, and why. */
RB_CHECKED enum rb_status rb_saving_ask(struct rb_saving *saving, struct rb_error *err);
/*
 * At the end by a signal: one of this frame, written and synced. A run that can't be kept here may
 * have an earlier one: `*frame` is that of the last one. RB_OK: there is one.
 */
RB_CHECKED enum rb_status rb_saving_last(struct rb_saving *saving, const struct rb_world *world,
                                         uint64_t *frame, struct rb_error *err);

#endif
