/* SPDX-License-Identifier: MIT */
/* b slides along an axis of a and turns about it. */
#include "joint/joint_types.h"

const struct rb_joint_type rb_joint_type_cylindrical = {
	.name = "cylindrical",
	.noun = "cylindrical joint",
	.linkage = {.condition = {&rb_linkage_on_axis, &rb_linkage_same_axis},
                    .coordinate = RB_COORDINATE_WAY,
                    .free = RB_FREE_ALONG | RB_FREE_ABOUT},
	.has_axis = true,
	.form = RB_JOINT_RAIL,
};
