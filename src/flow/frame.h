/* SPDX-License-Identifier: MIT */
/*
 * Storage of a frame (<rbsim/frame.h>): the columns that are both wanted and able to change.
 *
 * A frame belongs to whoever initialized it; one thread at a time. The columns keep their size;
 * `events` and `contacts` may be grown by whoever fills the frame, with rb_memory_reserve's rule,
 * and are never shrunk, so that after the first frames nothing is allocated.
 */
#ifndef RB_FLOW_FRAME_H
#define RB_FLOW_FRAME_H

#include <stddef.h>

#include <rbsim/frame.h>
#include <rbsim/model.h>

/*
 * What of `fields` (RB_FIELD_*) this model can change: without rotation no orientation and no
 * angular velocity.
 */
unsigned rb_frame_fields(const struct rb_model *model, unsigned fields);

/* Columns for `fields`; 0 gives a frame of numbers alone. Fails on memory only. */
RB_CHECKED enum rb_status rb_frame_init(struct rb_frame *frame, const struct rb_model *model,
                                        unsigned fields, struct rb_error *err);
void rb_frame_release(struct rb_frame *frame); /* safe on a zeroed frame */
/*
 * `count` frames whose columns of bodies follow one another without a gap, so that those of several
 * frames are written as one block. They are released together.
 */
RB_CHECKED enum rb_status rb_frame_init_all(struct rb_frame *frames, int count,
                                            const struct rb_model *model, unsigned fields,
                                            struct rb_error *err);
void rb_frame_release_all(struct rb_frame *frames, int count);

/* Bytes that the columns of such a frame take, without events and contacts. */
size_t rb_frame_bytes(const struct rb_model *model, unsigned fields);

/*
 * Adds where a camera stands at a picture; those of a frame are sorted by camera, then by picture.
 */
RB_CHECKED enum rb_status rb_frame_add_shot(struct rb_frame *frame,
                                            const struct rb_frame_shot *shot, struct rb_error *err);

#endif
