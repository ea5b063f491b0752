/* SPDX-License-Identifier: MIT */
/*
 * The located method: from event to event in order of time, each dealing only with the bodies that
 * it touches.
 *
 * Between events nobody is looked at; frames and callbacks see every body evaluated on its arc at
 * their moment, which changes nothing. With `rollback = "global"` every event evaluates the whole
 * scene at its moment and takes it back, as first described: the same bits at the cost that this
 * has.
 */
#ifndef RB_LOCATED_ENGINE_H
#define RB_LOCATED_ENGINE_H

#include "world/world.h"

struct rb_located;

/* Steps after the first failure to locate; RB_DENSE_STEPS_MORE times as many after each further. */
enum { RB_DENSE_STEPS_FIRST = 16, RB_DENSE_STEPS_MORE = 4 };

/*
 * All events up to `until_s`, callbacks called; the world's state is then as of that moment. Of a
 * scene that may also be stepped (method "auto"): gives way, with the state of a moment up to then,
 * where events of crowds come too densely; the next advance begins anew from the state as it then
 * is. RB_ERR_INTERRUPT when the world's `stop` said so.
 */
RB_CHECKED enum rb_status rb_engine_advance(struct rb_located *l, double until_s,
                                            struct rb_error *err);

/* False where the last advance has given way, or none has begun. */
bool rb_engine_locates(const struct rb_located *l);

/* s: simulated time that has been located without steps between, up to the last event. */
double rb_engine_located(const struct rb_located *l);

/* Whether callbacks or a change of method need the grid of time_step. */
bool rb_engine_wants_steps(const struct rb_located *l);

/* The world's state is that of an earlier moment: the next advance begins anew from there. */
void rb_engine_go_back(struct rb_located *l);

/* At a moment that it has come to: RB_ERR_PHYSICS names an overlap beyond the tolerance. */
RB_CHECKED enum rb_status rb_engine_check(struct rb_located *l, struct rb_error *err);

/*
 * At a frame: lists the lasting contacts and looks for overlaps; RB_ERR_PHYSICS names one beyond
 * the tolerance.
 */
RB_CHECKED enum rb_status rb_engine_inspect(struct rb_located *l, struct rb_error *err);

/*
 * A callback may have changed the world's state since it was stored: bodies that differ start new
 * arcs.
 */
RB_CHECKED enum rb_status rb_engine_take_changes(struct rb_located *l, double now_s,
                                                 struct rb_error *err);

#endif
