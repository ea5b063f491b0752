/* SPDX-License-Identifier: MIT */
/* Impacts of a single pair of bodies. */
#ifndef RB_LOCATED_PAIR_IMPACT_H
#define RB_LOCATED_PAIR_IMPACT_H

#include "located/event_set.h"

/*
 * Resolves an impact, in closed form, of two bodies that are not connected to others, touch no
 * other body, and are central to each other (spheres, or a sphere and a plane); they continue in
 * flight, and one that was on a piece keeps its cluster, which needs a new piece. False, with
 * nothing changed: not such a case; use rb_resolve_impacts.
 */
bool rb_pair_impact(struct rb_located *l, int a, int b, double t);

/*
 * True if a rebound at this speed, m/s, would stay within rounding of the size under this closing
 * acceleration of the gap, m/s^2, independent of positions.
 */
bool rb_pair_impact_ends(const struct rb_located *l, const struct rb_contact_point *m,
                         double target_velocity, double closing);

#endif
