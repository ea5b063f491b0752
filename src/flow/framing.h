/* SPDX-License-Identifier: MIT */
/*
 * Where a camera without a place of its own stands: so that it sees all that moves over the time it
 * shows.
 *
 * What moves away from everything to the end, and would make all else smaller than two pixels and
 * than half of what it is without, flies off for ever and is left out. Owned by whoever initialized
 * it; one thread.
 */
#ifndef RB_FLOW_FRAMING_H
#define RB_FLOW_FRAMING_H

#include <stdbool.h>
#include <stddef.h>

#include <rbsim/frame.h>
#include <rbsim/model.h>

struct rb_framing {
	const struct rb_model *model;
	struct rb_reach *reach; /* owned: of each body that is looked at */
	int first, count;       /* bodies by index: those that move, or all where nothing does */
	rb_vec3 middle;         /* m: of where they begin */
	double plate_most_m; /* half the diagonal of the largest finite plane that is no ground */
};

/* Knows where the model's bodies begin. Fails on memory only. */
RB_CHECKED enum rb_status rb_framing_init(struct rb_framing *framing, const struct rb_model *model,
                                          struct rb_error *err);
void rb_framing_release(struct rb_framing *framing); /* safe on a zeroed one */
/* A frame that is shown, in order of time. True: something is where nothing was before. */
bool rb_framing_see(struct rb_framing *framing, const struct rb_frame *frame);

/*
 * Puts `camera` where it sees what was seen so far, along its own line of sight. Whom it leaves out
 * is told in `text`, as "'ball', #3 and 2 more"; how many: the result.
 */
int rb_framing_aim(const struct rb_framing *framing, struct rb_camera_def *camera, char *text,
                   size_t size);

#endif
