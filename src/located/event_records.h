/* SPDX-License-Identifier: MIT */
/*
 * Impacts and transitions on their way to frames and callbacks: kept in the world's events, in
 * order of time.
 */
#ifndef RB_LOCATED_EVENT_RECORDS_H
#define RB_LOCATED_EVENT_RECORDS_H

#include "located/pair_contacts.h"

/* An impact: counted always, kept where frames or callbacks want it. */
void rb_record_impact(struct rb_located *l, double t, const struct rb_contact_point *m,
                      rb_vec3 impulse, double approach);
void rb_record_transition(struct rb_located *l, double t, enum rb_event_kind kind,
                          const struct rb_contact_point *m);

#endif
