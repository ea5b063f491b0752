/* SPDX-License-Identifier: MIT */
/*
 * What holds of the stepped method's state between steps: groups that stand are whole and counted,
 * candidates are pairs of bodies that there are.
 *
 * Pure functions; simulator thread. RB_ERR_BUG says what does not hold.
 */
#ifndef RB_STEPPED_STEPPED_INVARIANTS_H
#define RB_STEPPED_STEPPED_INVARIANTS_H

#include "stepped/stepped_state.h"

RB_CHECKED enum rb_status rb_validate_stepped(const struct rb_world *world, struct rb_error *err);

#endif
