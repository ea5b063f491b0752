/* SPDX-License-Identifier: MIT */
/* Impacts of all that touch at a moment. */
#ifndef RB_LOCATED_RESOLVE_IMPACT_H
#define RB_LOCATED_RESOLVE_IMPACT_H

#include "located/event_set.h"

/*
 * Everything that touches these two, together. Leaves the set, resolved (located/resolve_contacts);
 * no impact where nothing approaches.
 */
void rb_resolve_impacts(struct rb_located *l, int a, int b, double t);

#endif
