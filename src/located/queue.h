/* SPDX-License-Identifier: MIT */
/*
 * The earliest event of n bodies: an indexed priority queue with one time per body.
 *
 * Ties are broken by the body's number, so that the order does not depend on history. Owned by one
 * thread.
 */
#ifndef RB_LOCATED_QUEUE_H
#define RB_LOCATED_QUEUE_H

#include <rbsim/error.h>

struct rb_queue;

/* Initially all times are INFINITY. */
RB_CHECKED enum rb_status rb_queue_create(struct rb_queue **queue, int body_count,
                                          struct rb_error *err);
void rb_queue_destroy(struct rb_queue *queue); /* NULL is fine */

/* The time of a body's event, s: not NaN; INFINITY: none. */
void rb_queue_set(struct rb_queue *queue, int body, double time_s);
double rb_queue_time(const struct rb_queue *queue, int body);

/* The body with the earliest event and its time; -1 and INFINITY when there is none. */
int rb_queue_first(const struct rb_queue *queue, double *time_s);

/*
 * Hints for prefetching, without effect on results. rb_queue_soon: the body whose event comes about
 * k-th soonest, k = 1, 2, ...; -1: none. rb_queue_later: a body with an event after those, another
 * one with each call until there is none for now, -1. rb_queue_prefetch: this body's time will be
 * set soon.
 */
int rb_queue_soon(const struct rb_queue *queue, int k);
int rb_queue_later(struct rb_queue *queue);
void rb_queue_prefetch(const struct rb_queue *queue, int body);

#endif
