/* SPDX-License-Identifier: MIT */
/*
 * Energy, momentum and counts at a time; sums run over bodies in their order, for any number of
 * threads. Simulator's thread.
 */
#ifndef RB_METHOD_NUMBERS_H
#define RB_METHOD_NUMBERS_H

#include "world/world.h"

/*
 * Fills all but the counts. Potential energy includes that of gravity and gravity_force, zero at
 * the origin, and of force elements.
 */
void rb_numbers_measure(const struct rb_world *world, struct rb_frame_numbers *numbers);
/* Starts the ledger at the present state. */
void rb_numbers_start_ledger(struct rb_world *world);
/* Fills the columns of a frame except loads, its numbers, events and contacts; counts restart. */
RB_CHECKED enum rb_status rb_numbers_fill_frame(struct rb_world *world, struct rb_frame *frame,
                                                struct rb_error *err);
void rb_numbers_count(struct rb_frame_numbers *numbers, const struct rb_counts *counts,
                      size_t contacts);

#endif
