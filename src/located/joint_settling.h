/* SPDX-License-Identifier: MIT */
/* Joints in a settling: what its solution says of motors, and what the ledger is told of rest. */
#ifndef RB_LOCATED_JOINT_SETTLING_H
#define RB_LOCATED_JOINT_SETTLING_H

#include "located/slips.h"

/* Once solved: motors and friction of joints, held or at their bounds. False: no memory. */
bool rb_joint_settling_decide(struct rb_settling *s);

/*
 * Rates for the ledger of joints with fixed ends while a part is at rest, `own` being its bodies by
 * place: what balances all other forces on it.
 */
void rb_joint_settling_rate(const struct rb_settling *s, const bool *own,
                            struct rb_account_rates *rates);

#endif
