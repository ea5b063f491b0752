/* SPDX-License-Identifier: MIT */
/*
 * Records impacts and transitions for frames and callbacks in the world's events, in order of time.
 * Simulator's thread.
 */
#ifndef RB_LOCATED_EVENT_RECORDS_H
#define RB_LOCATED_EVENT_RECORDS_H

#include "located/pair_contacts.h"

/* Records an impact, which is always counted, and kept if frames or callbacks want it. */
void rb_record_impact(struct rb_located *l, double t, const struct rb_contact_point *m,
                      rb_vec3 impulse, double approach);
void rb_record_transition(struct rb_located *l, double t, enum rb_event_kind kind,
                          const struct rb_contact_point *m);

#endif
