/* SPDX-License-Identifier: MIT */
/* Impacts of two bodies alone. */
#ifndef RB_LOCATED_PAIR_IMPACT_H
#define RB_LOCATED_PAIR_IMPACT_H

#include "located/event_set.h"

/*
 * Two bodies that nothing joins to others, that touch nobody else and are central to each other
 * (spheres, or a sphere and a plane): one impact, in closed form, after which they fly on; whoever
 * was on a piece keeps the cluster, which needs a new one. False, and nothing is changed, where
 * that is not all there is to it: then rb_resolve_impacts.
 */
bool rb_pair_impact(struct rb_located *l, int a, int b, double t);

/*
 * True if a rebound at this speed, m/s, would stay within rounding of the size under this
 * acceleration, m/s^2, that closes the gap; positions do not matter.
 */
bool rb_pair_impact_ends(const struct rb_located *l, const struct rb_contact_point *m,
                         double target_velocity, double closing);

#endif
