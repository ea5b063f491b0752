/* SPDX-License-Identifier: MIT */
/* What a frame shows of contacts: those that last, and overlaps. */
#ifndef RB_LOCATED_INSPECT_H
#define RB_LOCATED_INSPECT_H

#include "located/event_set.h"

/* Fills the world's contacts with what lasts at `t`, with forces as steps would start from them. */
RB_CHECKED enum rb_status rb_inspect_contacts(struct rb_located *l, double t);
/* Fills `shown` with the same, with the forces of this very moment; changes nothing else. */
RB_CHECKED enum rb_status rb_inspect_forces(struct rb_located *l, double t,
                                            struct rb_contacts *shown);

/*
 * The deepest overlap of any two bodies at `t`, which the state is of, and whose it is; 0 and -1:
 * none. Two that have rested since the last time are not looked at again.
 */
double rb_inspect_overlap(struct rb_located *l, double t, int *a, int *b);

/* Does its arc leave the body where it is? At a moment that the state is of. */
bool rb_inspect_is_at_rest(const struct rb_located *l, int i);

/* Arcs begin anew: nothing is known of overlaps. */
void rb_inspect_forget(struct rb_located *l);

#endif
