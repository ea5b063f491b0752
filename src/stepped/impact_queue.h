/* SPDX-License-Identifier: MIT */
/*
 * Queue of a step's points by the time of their next impact: a binary heap, ties by point.
 *
 * Owned by the method's state. A point that is predicted again is added once more; the caller skips
 * its stale entries.
 */
#ifndef RB_STEPPED_IMPACT_QUEUE_H
#define RB_STEPPED_IMPACT_QUEUE_H

#include <stddef.h>

#include <rbsim/error.h>

struct rb_queued_impact {
	double t_s; /* after the beginning of the step */
	size_t point;
};

struct rb_impact_queue {
	struct rb_queued_impact *row; /* owned */
	size_t count, capacity;
};

RB_CHECKED enum rb_status rb_impact_queue_add(struct rb_impact_queue *queue,
                                              struct rb_queued_impact due, struct rb_error *err);

/* Removes and returns the first entry; the queue must not be empty. */
struct rb_queued_impact rb_impact_queue_next(struct rb_impact_queue *queue);

/* Removes stale entries: those whose time is not that of the point in `next_s`, [points]. */
void rb_impact_queue_keep(struct rb_impact_queue *queue, const double *next_s);

#endif
