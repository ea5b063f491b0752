/* SPDX-License-Identifier: MIT */
/*
 * Joints in a resolution of contacts: modes of their motors and stops, and their rates for the
 * ledger at rest.
 */
#ifndef RB_LOCATED_JOINT_REST_H
#define RB_LOCATED_JOINT_REST_H

#include "located/slips.h"

/*
 * After solving: decides the modes of motors and friction of joints, held or at their bounds, and
 * of stops, held or open; records changes. False: out of memory.
 */
bool rb_joint_rest_decide(struct rb_resolution *s);

/* Bodies moved by motors that follow are not at rest, whatever their present speed. */
void rb_joint_rest_follow(struct rb_resolution *s);

/*
 * Adds the rates for the ledger of joints with fixed ends while a part is at rest, `own` being its
 * bodies by place: the reaction to all other forces on it.
 */
void rb_joint_rest_rate(const struct rb_resolution *s, const bool *own,
                        struct rb_account_rates *rates);

#endif
