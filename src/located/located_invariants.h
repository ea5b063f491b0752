/* SPDX-License-Identifier: MIT */
/*
 * Invariants of the located method's state between events: each body is in at most one cluster,
 * contacts are named and sorted, no event is in the past, scratch is empty.
 *
 * Pure functions; simulator's thread. The message of RB_ERR_BUG names the violated one.
 */
#ifndef RB_LOCATED_LOCATED_INVARIANTS_H
#define RB_LOCATED_LOCATED_INVARIANTS_H

#include "located/located.h"

RB_CHECKED enum rb_status rb_validate_located(const struct rb_located *l, struct rb_error *err);

#endif
