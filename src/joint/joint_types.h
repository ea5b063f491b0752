/* SPDX-License-Identifier: MIT */
/* All kinds of joints. */
#ifndef RB_JOINT_JOINT_TYPES_H
#define RB_JOINT_JOINT_TYPES_H

#include "model/joint_type.h"

/*
 * All kinds: the end of the kind's name, and of the row's. A new one is a line here, one in enum
 * rb_joint_kind (after the last: recordings keep the numbers), its name in RB_JOINT_KIND_NAMES, and
 * a file beside this one.
 */
#define RB_JOINT_TYPES(TYPE)           \
	TYPE(FIXED, fixed)             \
	TYPE(BALL, ball)               \
	TYPE(HINGE, hinge)             \
	TYPE(SLIDER, slider)           \
	TYPE(CYLINDRICAL, cylindrical) \
	TYPE(UNIVERSAL, universal)     \
	TYPE(ROD, rod)                 \
	TYPE(ROPE, rope)

#define RB_JOINT_ROW(kind, name) extern const struct rb_joint_type rb_joint_type_##name;
RB_JOINT_TYPES(RB_JOINT_ROW)
#undef RB_JOINT_ROW

#endif
