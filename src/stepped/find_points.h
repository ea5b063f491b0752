/* SPDX-License-Identifier: MIT */
/* The narrow phase: contact points of all candidate pairs, by blocks. */
#ifndef RB_STEPPED_FIND_POINTS_H
#define RB_STEPPED_FIND_POINTS_H

#include "stepped/contact_points.h"

/*
 * Adds the points of live candidates; velocities as for rb_candidates_find. Warm impulses are for a
 * step of h_s. Points with a gap above `max`, m, are left out.
 */
RB_CHECKED enum rb_status rb_step_points_add(struct rb_step_points *points, struct rb_world *world,
                                             struct rb_candidates *candidates, double h_s,
                                             double max, struct rb_error *err);

#endif
