/* SPDX-License-Identifier: MIT */
/* Two bodies as one. */
#include "joint/joint_types.h"

const struct rb_joint_type rb_joint_type_fixed = {
	.name = "fixed",
	.noun = "fixed joint",
	.linkage = {.condition = {&rb_linkage_same_point, &rb_linkage_same_turn},
                    .free = RB_FREE_NOTHING},
	.is_centered = true,
	.form = RB_JOINT_UNSEEN,
};
