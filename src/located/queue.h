/* SPDX-License-Identifier: MIT */
/*
 * Which of n bodies has the earliest event: an indexed priority queue with one time per body.
 *
 * Ties are broken by the body's number, so that the order does not depend on history. Owned by one
 * thread.
 */
#ifndef RB_LOCATED_QUEUE_H
#define RB_LOCATED_QUEUE_H

#include <rbsim/error.h>

struct rb_queue;

/* All times are INFINITY to begin with. */
RB_CHECKED enum rb_status rb_queue_create(struct rb_queue **queue, int body_count,
                                          struct rb_error *err);
void rb_queue_destroy(struct rb_queue *queue); /* NULL is fine */

/* The time of a body's event, s: not NaN; INFINITY: none. */
void rb_queue_set(struct rb_queue *queue, int body, double time_s);
double rb_queue_time(const struct rb_queue *queue, int body);

/* The body with the earliest event and its time; -1 and INFINITY when there is none. */
int rb_queue_first(const struct rb_queue *queue, double *time_s);

/*
 * Hints that change nothing, for those who fetch what they will need. Whose event may come soon: k
 * = 1, 2, .., the sooner the smaller k, roughly; -1: nobody. Whose may come after those: another
 * one with every call, until there is none for the time being: -1. And: this body's time will be
 * set soon.
 */
int rb_queue_soon(const struct rb_queue *queue, int k);
int rb_queue_later(struct rb_queue *queue);
void rb_queue_prefetch(const struct rb_queue *queue, int body);

#endif
