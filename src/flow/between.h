/* SPDX-License-Identifier: MIT */
/*
 * A frame at a time between two others, and copies of frames: what slow motion and time lapse show.
 *
 * Positions and velocities are interpolated on straight lines (an impact in between must not make a body swing
 * through a floor), orientations on the sphere of unit quaternions, by the whole turns that the angular velocities of
 * both ends tell where they are there. Energies are interpolated, counts are those of the later frame, contacts,
 * events and shots are those of the later frame.
 */
#ifndef RB_FLOW_BETWEEN_H
#define RB_FLOW_BETWEEN_H

#include <rbsim/frame.h>

/* Makes `to` (zeroed, or used here before) the same as `from`, with memory of its own that is kept for the next time.
 * Fails on memory only. Released with rb_frame_release. */
RB_CHECKED enum rb_status rb_frame_copy(struct rb_frame *to, const struct rb_frame *from,
                                        struct rb_error *err);

/* `out` becomes what lies between a and b at `time_s`, a->time_s <= time_s <= b->time_s; at either end it is that
 * frame to the bit. `out` is zeroed or was used here before. Fails on memory only. */
RB_CHECKED enum rb_status rb_frame_between(struct rb_frame *out, const struct rb_frame *a,
                                           const struct rb_frame *b, double time_s,
                                           struct rb_error *err);

#endif
