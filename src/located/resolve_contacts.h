/* SPDX-License-Identifier: MIT */
/*
 * Restarts bodies after an event: finds which of their touching contacts last, the forces of these,
 * and the bodies' new arcs.
 */
#ifndef RB_LOCATED_RESOLVE_CONTACTS_H
#define RB_LOCATED_RESOLVE_CONTACTS_H

#include "located/event_set.h"

/*
 * Resolves the contacts of the set, grown by all bodies that rest on it: gives every body of it a
 * new arc from `t` on, dissolves the previous clusters, creates the new ones, and records
 * transitions. `after_impact`: an impact or a callback has just changed velocities, which are
 * exact; `slack`, m/s: the rounding that it has added to that of the velocities themselves. Leaves
 * the set, whose bodies must then be predicted anew. Sets l->status.
 *
 * False, with nothing changed but the set: a lasting contact approaches by more than drift, as when
 * one rolls on to another feature, or another point of a rim that has landed flat does. `hit` is
 * its pair, for an impact (rb_resolve_impacts). hit NULL: this is not checked.
 */
bool rb_resolve_contacts(struct rb_located *l, double t, bool after_impact, double slack,
                         int hit[2]);

#endif
