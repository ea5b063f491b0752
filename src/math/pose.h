/* SPDX-License-Identifier: MIT */
/* All of a body at one moment. */
#ifndef RB_MATH_POSE_H
#define RB_MATH_POSE_H

#include <rbsim/math.h>

#include "math/vec3.h"

struct rb_pose {
	rb_vec3 position; /* centre of mass */
	rb_vec3 rest; /* m: what rounding leaves out of `position`, of what is or was on a piece */
	rb_vec3 origin; /* of the object, centre of its shape */
	rb_quat orientation;
	rb_vec3 velocity, spin;
};

/* From a's centre of mass to b's: as exact near as far from the world's origin. */
static inline rb_vec3 rb_pose_between(const struct rb_pose *a, const struct rb_pose *b)
{
	return rb_vec3_add(rb_vec3_sub(b->position, a->position), rb_vec3_sub(b->rest, a->rest));
}

#endif
