/* SPDX-License-Identifier: MIT */
/*
 * All of a recording that does not change from frame to frame: who, how, the bodies, the scene
 * (rbsim-recording(5)).
 */
#ifndef RB_SINK_H5ABOUT_H
#define RB_SINK_H5ABOUT_H

#include "flow/run_info.h"
#include "sink/h5file.h"

/* Room of the texts that change. */
enum {
	RB_ABOUT_STATUS_ROOM = 16,
	RB_ABOUT_REASON_ROOM = 256,
	RB_ABOUT_HASH_ROOM = 16,
	RB_ABOUT_ENDED_ROOM = 32
};

/* `h5->file` is open and empty. */
void rb_about_write(struct rb_h5 *h5, const struct rb_run_info *info);
/* Then: the texts that change, as they are at the start. */
void rb_about_write_changing(struct rb_h5 *h5);

#endif
