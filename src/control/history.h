/* SPDX-License-Identifier: MIT */
/*
 * The last frames of a run, kept for whoever looks at it from outside: 600 of them, or as many as
 * fit into 64 MiB.
 *
 * Frames are kept by the simulator's thread, which waits for nothing but a copy in the other
 * direction; copies out may be made by any thread. Owned by whoever created it; made and destroyed
 * when nobody else uses it.
 */
#ifndef RB_CONTROL_HISTORY_H
#define RB_CONTROL_HISTORY_H

#include <stdbool.h>

#include <rbsim/frame.h>
#include <rbsim/model.h>

struct rb_history;

#define RB_HISTORY_NEWEST UINT64_MAX
enum { RB_HISTORY_FRAMES_MAX = 600, RB_HISTORY_FIELDS = RB_FIELD_DEFAULT };

/* Memory is taken as frames come. */
RB_CHECKED enum rb_status rb_history_create(struct rb_history **history,
                                            const struct rb_model *model, struct rb_error *err);
void rb_history_destroy(struct rb_history *history); /* NULL is fine */

/*
 * Frames come in order, from index 0 on. Poses, velocities and numbers are kept; contacts, events
 * and shots are not.
 */
RB_CHECKED enum rb_status rb_history_keep(struct rb_history *history, const struct rb_frame *frame,
                                          struct rb_error *err);
/* The first and the last frame that are kept; false: none. */
bool rb_history_range(struct rb_history *history, uint64_t *first, uint64_t *last);
/*
 * The frame of an index, or the newest, into one that is zeroed or was used here before.
 * RB_ERR_INPUT when it is not kept (any more).
 */
RB_CHECKED enum rb_status rb_history_copy(struct rb_history *history, uint64_t index,
                                          struct rb_frame *to, struct rb_error *err);

#endif
