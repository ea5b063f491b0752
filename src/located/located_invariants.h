/* SPDX-License-Identifier: MIT */
/*
 * What holds of the located method's state between events: every body in one cluster at most,
 * contacts named and sorted, nobody's event in the past, nothing left of what scratch held.
 *
 * Pure functions; simulator thread. RB_ERR_BUG says what does not hold.
 */
#ifndef RB_LOCATED_LOCATED_INVARIANTS_H
#define RB_LOCATED_LOCATED_INVARIANTS_H

#include "located/located.h"

RB_CHECKED enum rb_status rb_validate_located(const struct rb_located *l, struct rb_error *err);

#endif
