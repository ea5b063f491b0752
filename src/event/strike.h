/* SPDX-License-Identifier: MIT */
/* Impacts: of two bodies alone, and of all that touch at that moment. */
#ifndef RB_EVENT_STRIKE_H
#define RB_EVENT_STRIKE_H

#include "event/set.h"

/*
 * Two bodies that are in no cluster, touch nobody else and are central to each other (spheres, or a sphere and a plane):
 * one impact, in closed form, after which they fly on. False, and nothing is changed, where that is not all there is to
 * it: then rb_strike_all.
 */
bool rb_strike_pair(struct rb_located *l, int a, int b, double t);

/*
 * Everything that touches these two, together. Leaves the set, settled (event/settle); no impact where nothing
 * approaches.
 */
void rb_strike_all(struct rb_located *l, int a, int b, double t);

#endif
