/* SPDX-License-Identifier: MIT */
/*
 *  * The located method: handles events in order of time; each changes only the bodies that it
 * involves.
 *
 * Between events no body is evaluated. For frames and callbacks every body is evaluated on its arc,
 * which changes no state. With `rollback = "global"` every event evaluates the whole scene at its
 * time and rolls it back, as the method was first described: the same bits at a higher cost.
 */
#ifndef RB_LOCATED_ENGINE_H
#define RB_LOCATED_ENGINE_H

#include "world/world.h"

struct rb_located;

/*
 * Steps after the first failure to locate; each further failure takes RB_DENSE_STEPS_MORE times as
 * many.
 */
enum { RB_DENSE_STEPS_FIRST = 16, RB_DENSE_STEPS_MORE = 4 };

/*
 * Handles all events up to `until_s` and calls callbacks; the world's state is then that of
 * `until_s`. If the scene may also be stepped (method "auto") and events are too dense, stops early
 * with the state of the time reached; the next advance begins anew from the world's state.
 * RB_ERR_INTERRUPT if the world's `stop` callback says so.
 */
RB_CHECKED enum rb_status rb_engine_advance(struct rb_located *l, double until_s,
                                            struct rb_error *err);

/* True while arcs exist: false if the last advance has stopped early, or none has begun. */
bool rb_engine_locates(const struct rb_located *l);

/* Simulated time located without steps in between, up to the last event, s. */
double rb_engine_located_time(const struct rb_located *l);

/* True if callbacks or a change of method need the grid of time_step. */
bool rb_engine_wants_steps(const struct rb_located *l);

/*
 * Discards arcs after the world's state was restored to an earlier time; the next advance begins
 * anew from it.
 */
void rb_engine_roll_back(struct rb_located *l);

/* Checks overlaps at the time reached; RB_ERR_PHYSICS names one beyond the tolerance. */
RB_CHECKED enum rb_status rb_engine_check(struct rb_located *l, struct rb_error *err);

/*
 * At a frame: lists the lasting contacts and checks overlaps; RB_ERR_PHYSICS names one beyond the
 * tolerance.
 */
RB_CHECKED enum rb_status rb_engine_inspect(struct rb_located *l, struct rb_error *err);

/* Starts new arcs for bodies whose state a callback has changed since it was stored. */
RB_CHECKED enum rb_status rb_engine_take_changes(struct rb_located *l, double now_s,
                                                 struct rb_error *err);

#endif
