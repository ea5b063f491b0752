/* SPDX-License-Identifier: MIT */
/*
 * A spring with a damper between points of two bodies: tension k (length - rest length) + c times
 * the rate at which it grows longer, along the line between its ends.
 */
#ifndef RB_FORCE_SPRING_H
#define RB_FORCE_SPRING_H

#include "model/element.h"

extern const struct rb_element_kind rb_force_spring; /* rows: struct rb_spring_def */

static inline struct rb_spring_def *rb_scene_spring(const struct rb_scene *scene, int k)
{
	return rb_scene_element(scene, &rb_force_spring, k);
}

#endif
