/* SPDX-License-Identifier: MIT */
/*
 * A frame at a time between two others, and copies of frames: what slow motion and time lapse show.
 *
 * Where both frames have velocities and the later one has the impacts of the interval (has_events),
 * centres of mass go from impact to impact on the cubic that has the positions and velocities of
 * both: exact for a constant acceleration, and velocities jump at the impacts, or, where a step has
 * resolved them as a whole, within that step. Else positions and velocities go straight.
 * Orientations follow the angular momentum that the spins of both frames
 * and the impacts tell, whole turns and all; without spins the great circle. Energies are
 * interpolated, counts, contacts, events and shots are those of the later frame.
 */
#ifndef RB_FLOW_BETWEEN_H
#define RB_FLOW_BETWEEN_H

#include <stddef.h>

#include <rbsim/frame.h>
#include <rbsim/model.h>

/*
 * Makes `to` (zeroed, or used here before) the same as `from`, with memory of its own that is kept
 * for the next time. Fails on memory only. Released with rb_frame_release.
 */
RB_CHECKED enum rb_status rb_frame_copy(struct rb_frame *to, const struct rb_frame *from,
                                        struct rb_error *err);

/* A moment, and what finding it needs; zeroed to begin with. One thread. */
struct rb_between {
	struct rb_frame frame;
	int *first, *next; /* owned: impacts by body */
	size_t first_capacity, next_capacity;
};
void rb_between_release(struct rb_between *between); /* safe on a zeroed one */

/*
 * `between->frame` becomes what lies between a and b, frames of `model`, at `time_s`, a->time_s <=
 * time_s <= b->time_s; at either end it is that frame to the bit. Fails on memory only.
 */
RB_CHECKED enum rb_status rb_frame_between(struct rb_between *between, const struct rb_model *model,
                                           const struct rb_frame *a, const struct rb_frame *b,
                                           double time_s, struct rb_error *err);

#endif
