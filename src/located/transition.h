/* SPDX-License-Identifier: MIT */
/* When a cluster's lasting contacts next change what they do. */
#ifndef RB_LOCATED_TRANSITION_H
#define RB_LOCATED_TRANSITION_H

#include "located/located.h"

/*
 * Of a cluster as it was resolved: its next own event (an end of slip, of a face, of a piece, of an
 * accumulation; or rounding about to take a contact out of its band), s; INFINITY: none.
 */
double rb_transition_next(const struct rb_located *l, int cluster);

#endif
