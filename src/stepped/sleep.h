/* SPDX-License-Identifier: MIT */
/*
 * Groups that stand still: what was found of them in the step before is still so, and nobody looks
 * at them.
 *
 * A group stands once it has rested for a whole step under the same forces and has not moved by a
 * bit. It stands until its forces change, somebody puts it elsewhere, or something that does not
 * stand could touch it; then its points are found anew, which are those of before. So a run has the
 * same bits as one in which nothing ever stands. Contacts and impulses of what stands stay in the
 * world's lists. Owned by the method's state; simulator thread.
 */
#ifndef RB_STEPPED_SLEEP_H
#define RB_STEPPED_SLEEP_H

#include "stepped/inside.h"

RB_CHECKED enum rb_status rb_sleep_create(struct rb_sleep *sleep, const struct rb_model *model,
                                          struct rb_error *err);
void rb_sleep_release(struct rb_sleep *sleep);

/* The cohort of all is all bodies again, before forces are added. */
void rb_sleep_gather(struct rb_stepped *s);

/*
 * Points of the cohort of all in a step of h_s, whose forces are in the velocities: it shrinks to
 * what does not stand, and what does gets back the velocity that it had, none.
 */
RB_CHECKED enum rb_status rb_sleep_points(struct rb_world *world, double start_s, double h_s,
                                          struct rb_error *err);

/* After candidates have been found anew: which of them are live. */
RB_CHECKED enum rb_status rb_sleep_list(struct rb_world *world, struct rb_error *err);

/* After that step has been solved: which groups may stand from now on. */
void rb_sleep_note(struct rb_world *world);
/*
 * The step is kept, and its contacts are the world's: those stand that have not moved, nor have a
 * mark in `failed` (or NULL).
 */
void rb_sleep_end(struct rb_world *world, double end_s, const unsigned char *failed);
/* Those with a mark stand no longer. */
void rb_sleep_wake(struct rb_world *world, const unsigned char *mark);

/* Nothing stands. */
void rb_sleep_forget(struct rb_stepped *s);

#endif
