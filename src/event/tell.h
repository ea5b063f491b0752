/* SPDX-License-Identifier: MIT */
/* Impacts and transitions on their way to frames and callbacks: kept in the world's events, in order of time. */
#ifndef RB_EVENT_TELL_H
#define RB_EVENT_TELL_H

#include "event/meet.h"

/* An impact: counted always, kept where frames or callbacks want it. */
void rb_tell_impact(struct rb_located *l, double t, const struct rb_meet *m, rb_vec3 impulse,
                    double approach);
void rb_tell_transition(struct rb_located *l, double t, enum rb_event_kind kind,
                        const struct rb_meet *m);

#endif
