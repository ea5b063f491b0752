/* SPDX-License-Identifier: MIT */
/* Time of the next change of a cluster's lasting contacts. */
#ifndef RB_LOCATED_TRANSITION_H
#define RB_LOCATED_TRANSITION_H

#include "located/located.h"

/*
 * Returns the time of the next event of a cluster, as it was resolved (the end of a slip, a face, a
 * piece or an accumulation; or rounding that may take a contact out of its band), s; INFINITY:
 * none.
 */
double rb_transition_next(const struct rb_located *l, int cluster);

#endif
