/* SPDX-License-Identifier: MIT */
/*
 * Rows on their way to the file: the buffers of sink/h5frames are filled, and appended to its
 * datasets. Owned by the thread that owns these.
 */
#ifndef RB_SINK_H5ROWS_H
#define RB_SINK_H5ROWS_H

#include "sink/h5frames.h"

/*
 * Copies a frame, or keeps it; there must be room (rb_frames_full says no). RB_ERR_BUG: a column is
 * missing; RB_ERR_MEMORY.
 */
RB_CHECKED enum rb_status rb_frames_take(struct rb_frames *frames, const struct rb_frame *frame,
                                         struct rb_error *err);
/* How many of the last frames must stay as they are. */
int rb_frames_kept(const struct rb_frames *frames);
void rb_frames_commit(struct rb_frames *frames); /* the pending frame too */

/* Write columns of bodies before the next one is taken; write everything. */
bool rb_frames_full(const struct rb_frames *frames);
bool rb_frames_due(const struct rb_frames *frames);
uint64_t rb_frames_need(const struct rb_frames *frames); /* bytes that writing may take at most */
/* Appends what is committed of bodies and joints: they are there when the rest is, too. */
void rb_frames_write_bodies(struct rb_h5 *h5, struct rb_frames *frames);
/* Appends what is committed, `step` last. */
void rb_frames_write(struct rb_h5 *h5, struct rb_frames *frames);
/*
 * Where there is no room for more: appends what frames lack of which the bodies are written, and
 * forgets the others. rb_frames_need has counted it.
 */
void rb_frames_write_rest(struct rb_h5 *h5, struct rb_frames *frames);

#endif
