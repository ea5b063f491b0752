/* SPDX-License-Identifier: MIT */
/* A length between two points, kept; it has no mass. */
#include "joint/joint_types.h"

const struct rb_joint_type rb_joint_type_rod = {
	.name = "rod",
	.noun = "rod",
	.linkage = {.condition = {&rb_linkage_length}, .coordinate = RB_COORDINATE_LENGTH},
	.form = RB_JOINT_BAR,
};
