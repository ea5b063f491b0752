/* SPDX-License-Identifier: MIT */
/* A point in common, about which b turns as it likes. */
#include "joint/joint_types.h"

const struct rb_joint_type rb_joint_type_ball = {
	.name = "ball",
	.noun = "ball joint",
	.linkage = {.condition = {&rb_linkage_same_point}, .free = RB_FREE_TURNING},
	.form = RB_JOINT_KNOB,
};
