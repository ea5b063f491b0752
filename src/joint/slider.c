/* SPDX-License-Identifier: MIT */
/* b slides along an axis of a and does not turn against a. */
#include "joint/joint_types.h"

const struct rb_joint_type rb_joint_type_slider = {
	.name = "slider",
	.noun = "slider",
	.linkage = {.condition = {&rb_linkage_on_axis, &rb_linkage_same_turn},
                    .coordinate = RB_COORDINATE_WAY,
                    .free = RB_FREE_ALONG},
	.has_axis = true,
	.is_centered = true,
	.form = RB_JOINT_RAIL,
};
