/* SPDX-License-Identifier: MIT */
/* A length between two points that is not exceeded; it has no mass. */
#include "joint/joint_types.h"

const struct rb_joint_type rb_joint_type_rope = {
	.name = "rope",
	.noun = "rope",
	.linkage = {.condition = {&rb_linkage_length},
                    .coordinate = RB_COORDINATE_LENGTH,
                    .one_sided = true},
	.form = RB_JOINT_CORD,
};
