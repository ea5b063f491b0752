/* SPDX-License-Identifier: MIT */
/* Index of contact points by body. */
#ifndef RB_STEPPED_POINTS_OF_H
#define RB_STEPPED_POINTS_OF_H

#include "stepped/stepped_state.h"

/*
 * Points of each dynamic body: of[first[i]] to of[first[i + 1] - 1]; first: [bodies + 3], of: two
 * for each point. held, [bodies + 1]: whether a contact had a force on it in the last step. False:
 * no memory.
 */
bool rb_points_of_bodies(const struct rb_world *world, const struct rb_step_points *points,
                         size_t *first, size_t *of, unsigned char *held);

#endif
