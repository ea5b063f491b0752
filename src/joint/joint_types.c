/* SPDX-License-Identifier: MIT */
/*
 * The table of joint kinds in the order of enum rb_joint_kind, whose numbers recordings keep, from
 * one list of names.
 */
#include "joint/joint_types.h"

#define ROW(kind, name) [RB_JOINT_##kind] = &rb_joint_type_##name,
const struct rb_joint_type *const rb_joint_types[RB_JOINT_KIND_COUNT] = {RB_JOINT_TYPES(ROW)};

const struct rb_coordinate_words rb_coordinate_words[] = {
	[RB_COORDINATE_ANGLE] = {"angle", "torque", "rad", "rad/s"},
	[RB_COORDINATE_WAY] = {"way", "force", "m", "m/s"},
	[RB_COORDINATE_LENGTH] = {"length", NULL, "m", "m/s"},
};
