/* SPDX-License-Identifier: MIT */
/* Simultaneous impacts of all touching bodies at a moment. */
#ifndef RB_LOCATED_RESOLVE_IMPACT_H
#define RB_LOCATED_RESOLVE_IMPACT_H

#include "located/event_set.h"

/*
 * Resolves the impacts of all that touches these two bodies, together. Leaves the set with its
 * contacts resolved (located/resolve_contacts); no impact if nothing approaches.
 */
void rb_resolve_impacts(struct rb_located *l, int a, int b, double t);

#endif
