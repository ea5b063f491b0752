/* SPDX-License-Identifier: MIT */
/* A point and an axis in common: b turns about it. */
#include "joint/joint_types.h"

const struct rb_joint_type rb_joint_type_hinge = {
	.name = "hinge",
	.noun = "hinge",
	.linkage = {.condition = {&rb_linkage_same_point, &rb_linkage_same_axis},
                    .coordinate = RB_COORDINATE_ANGLE,
                    .free = RB_FREE_ABOUT},
	.has_axis = true,
	.form = RB_JOINT_PIN,
};
