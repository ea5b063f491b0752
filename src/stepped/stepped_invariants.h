/* SPDX-License-Identifier: MIT */
/*
 * Invariants of the stepped method's state between steps: sleeping groups are complete and counted,
 * candidates are pairs of existing bodies.
 *
 * Pure functions; simulator thread. RB_ERR_BUG states what is violated.
 */
#ifndef RB_STEPPED_STEPPED_INVARIANTS_H
#define RB_STEPPED_STEPPED_INVARIANTS_H

#include "stepped/stepped_state.h"

RB_CHECKED enum rb_status rb_validate_stepped(const struct rb_world *world, struct rb_error *err);

#endif
