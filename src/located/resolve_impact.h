/* SPDX-License-Identifier: MIT */
/* Impacts: of two bodies alone, and of all that touch at that moment. */
#ifndef RB_LOCATED_RESOLVE_IMPACT_H
#define RB_LOCATED_RESOLVE_IMPACT_H

#include "located/set.h"

/*
 * Two bodies that nothing joins to others, that touch nobody else and are central to each other
 * (spheres, or a sphere and a plane): one impact, in closed form, after which they fly on; whoever
 * was on a piece keeps the cluster, which needs a new one. False, and nothing is changed, where
 * that is not all there is to it: then rb_resolve_impacts.
 */
bool rb_resolve_impact_of_pair(struct rb_located *l, int a, int b, double t);

/*
 * Everything that touches these two, together. Leaves the set, resolved (located/resolve_contacts);
 * no impact where nothing approaches.
 */
void rb_resolve_impacts(struct rb_located *l, int a, int b, double t);

#endif
