/* SPDX-License-Identifier: MIT */
/*
 * Sleeping groups: steps skip them and keep their contacts and impulses in the world's lists.
 *
 * A group falls asleep when a whole step under the same forces has changed no bit of its state. It
 * wakes when its forces change, a callback moves it, a driven body that a joint ties to it moves,
 * or an awake body may touch it; its contact points, found again, are then the same as before. So a
 * run has the same bits as one without sleeping. Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_SLEEP_H
#define RB_STEPPED_SLEEP_H

#include "stepped/stepped_state.h"

RB_CHECKED enum rb_status rb_sleep_create(struct rb_sleep *sleep, const struct rb_model *model,
                                          struct rb_error *err);
void rb_sleep_release(struct rb_sleep *sleep);

/* Makes all bodies, including sleeping ones, the cohort of all again, before forces are added. */
void rb_sleep_gather(struct rb_stepped *s);

/*
 * Finds the contact points of the cohort of all in a step of h_s, whose forces are already in the
 * velocities. The cohort shrinks to awake bodies; sleeping ones get back their velocity, zero.
 */
RB_CHECKED enum rb_status rb_sleep_points(struct rb_world *world, double start_s, double h_s,
                                          struct rb_error *err);

/* Lists the live pairs, those with an awake body, after a new search for candidates. */
RB_CHECKED enum rb_status rb_sleep_list(struct rb_world *world, struct rb_error *err);

/* Marks groups that may fall asleep, after the step has been solved. */
void rb_sleep_mark(struct rb_world *world);
/*
 * Ends a step that is kept, when its contacts are the world's: marked groups fall asleep if none of
 * their bodies has moved or has a mark in `failed` (NULL: none has).
 */
void rb_sleep_end(struct rb_world *world, double end_s, const unsigned char *failed);
/* Wakes the groups of bodies with a mark. */
void rb_sleep_wake(struct rb_world *world, const unsigned char *mark);

/* Wakes all groups. */
void rb_sleep_forget(struct rb_stepped *s);

#endif
