/* SPDX-License-Identifier: MIT */
/*
 * The bodies that one event deals with together: l->set, and l->place for each of them. One set at a time.
 */
#ifndef RB_EVENT_SET_H
#define RB_EVENT_SET_H

#include "event/meet.h"

/* Adds a body that yields; a fixed one and one that is in it already are left out. */
void rb_set_add(struct rb_located *l, int i);
void rb_set_clear(struct rb_located *l);

/* Every moving body that could touch this one: all, or those in the cells around it. Writes to l->near. */
int rb_set_near(const struct rb_located *l, int i);

/* Is this pair held in a lasting contact? */
const struct rb_held *rb_set_held(const struct rb_located *l, int a, int b);

/* Which pairs join: called with a pair that touches, or is held. */
typedef bool rb_set_joins(const struct rb_located *l, const struct rb_meet *m, double t,
                          double slack);

/*
 * Grows the set to all that is joined to it by clusters, springs and touching pairs that `joins` accepts, and writes the
 * pairs between its bodies, and between them and fixed bodies, to the arena: *found, sorted by (a, b). Returns how many;
 * -1 when memory is out.
 */
int rb_set_grow(struct rb_located *l, double t, double slack, rb_set_joins *joins,
                struct rb_meet **found);

/* All touching pairs, whichever way they move. */
bool rb_set_touching(const struct rb_located *l, const struct rb_meet *m, double t, double slack);
/* Touching pairs that do not part. */
bool rb_set_lasting(const struct rb_located *l, const struct rb_meet *m, double t, double slack);

#endif
