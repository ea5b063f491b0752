/* SPDX-License-Identifier: MIT */
/*
 * Points of a step by the time at which each is an impact next: a binary heap, ties by point.
 *
 * Owned by the method's state; a point that is foreseen anew is added once more, and what it was
 * due at before is for the caller to skip.
 */
#ifndef RB_STEPPED_IMPACT_QUEUE_H
#define RB_STEPPED_IMPACT_QUEUE_H

#include <stddef.h>

#include <rbsim/error.h>

struct rb_due_impact {
	double t_s; /* after the beginning of the step */
	size_t point;
};

struct rb_impact_queue {
	struct rb_due_impact *row; /* owned */
	size_t count, capacity;
};

RB_CHECKED enum rb_status rb_impact_queue_add(struct rb_impact_queue *queue,
                                              struct rb_due_impact due, struct rb_error *err);

/* Removes and returns the first; there is one. */
struct rb_due_impact rb_impact_queue_next(struct rb_impact_queue *queue);

/* Leaves out what is not due at its point's time any more, [points]. */
void rb_impact_queue_keep(struct rb_impact_queue *queue, const double *due_s);

#endif
