/* SPDX-License-Identifier: MIT */
/*
 * Energy, momentum and counts of a moment; sums run over bodies in their order, whatever the
 * threads.
 */
#ifndef RB_METHOD_NUMBERS_H
#define RB_METHOD_NUMBERS_H

#include "world/world.h"

/*
 * Fills all but the counts. Potential energy is of gravity and gravity_force, zero at the origin.
 */
void rb_numbers_measure(const struct rb_world *world, struct rb_frame_numbers *numbers);
/* The ledger counts from here on. */
void rb_numbers_start_ledger(struct rb_world *world);
/*
 * Fills the columns of a frame but what acts on bodies, its numbers, events and contacts; counts
 * begin anew.
 */
RB_CHECKED enum rb_status rb_numbers_fill_frame(struct rb_world *world, struct rb_frame *frame,
                                                struct rb_error *err);
void rb_numbers_count(struct rb_frame_numbers *numbers, const struct rb_counts *counts,
                      size_t contacts);

#endif
