/* SPDX-License-Identifier: MIT */
/* Joints in a resolution: what it says of motors, and what the ledger records at rest. */
#ifndef RB_LOCATED_JOINT_REST_H
#define RB_LOCATED_JOINT_REST_H

#include "located/slips.h"

/*
 * Once solved: motors and friction of joints, held or at their bounds, and stops, held or open;
 * records what has changed. False: no memory.
 */
bool rb_joint_rest_decide(struct rb_resolution *s);

/* What motors that follow move is not at rest, whatever it does at this moment. */
void rb_joint_rest_follow(struct rb_resolution *s);

/*
 * Rates for the ledger of joints with fixed ends while a part is at rest, `own` being its bodies by
 * place: what balances all other forces on it.
 */
void rb_joint_rest_rate(const struct rb_resolution *s, const bool *own,
                        struct rb_account_rates *rates);

#endif
