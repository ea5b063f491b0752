/* SPDX-License-Identifier: MIT */
/* Contacts and overlaps for frames and reports. Simulator's thread. */
#ifndef RB_LOCATED_INSPECT_H
#define RB_LOCATED_INSPECT_H

#include "located/event_set.h"

/*
 * Fills the world's contacts with those that last at `t`, with forces for the warm start of steps.
 */
RB_CHECKED enum rb_status rb_inspect_contacts(struct rb_located *l, double t);
/* Fills `shown` with the same contacts and their present forces; changes nothing else. */
RB_CHECKED enum rb_status rb_inspect_forces(struct rb_located *l, double t,
                                            struct rb_contacts *shown);

/*
 * Depth of the deepest overlap of any two bodies at `t`, which the state must be of, and the
 * bodies; 0 and -1: none. Pairs at rest since the last call are not examined again.
 */
double rb_inspect_overlap(struct rb_located *l, double t, int *a, int *b);

/* RB_ERR_PHYSICS, and names the body, if the state, finite at `start_s`, no longer is. */
RB_CHECKED enum rb_status rb_inspect_finite(const struct rb_located *l, double start_s);

/* True if the body does not move on its arc, at the time of the state. */
bool rb_inspect_is_at_rest(const struct rb_located *l, int i);

/* Forgets results of earlier calls, when arcs begin anew. */
void rb_inspect_forget(struct rb_located *l);

#endif
