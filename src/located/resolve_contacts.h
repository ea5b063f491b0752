/* SPDX-License-Identifier: MIT */
/*
 * What becomes of bodies after something has happened to them: which of their touching contacts
 * last, with what forces, and on which arcs they go on.
 */
#ifndef RB_LOCATED_RESOLVE_CONTACTS_H
#define RB_LOCATED_RESOLVE_CONTACTS_H

#include "located/event_set.h"

/*
 * For the set as it is, grown to all that rests on it: gives every body of it a new arc from `t`
 * on, dissolves the clusters that they were in, makes those that they are in now, and tells
 * transitions. `after_impact`: an impact or a callback has just changed velocities, which are right
 * as they are; `slack` m/s: the rounding that it has left on top of that of the velocities
 * themselves. Leaves the set, whose bodies are then to foresee anew. Sets l->status.
 *
 * False, and nothing is changed but the set: a contact that has lasted approaches by more than can
 * have drifted, as where one rolls on to another feature; or another point of a rim that has landed
 * flat. `hit` is its pair: an impact (rb_resolve_impacts). NULL: it is not asked for.
 */
bool rb_resolve_contacts(struct rb_located *l, double t, bool after_impact, double slack,
                         int hit[2]);

#endif
