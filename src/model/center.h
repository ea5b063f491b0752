/* SPDX-License-Identifier: MIT */
/* From the origin of a body's shape to its centre of mass, and back. Pure functions. */
#ifndef RB_MODEL_CENTER_H
#define RB_MODEL_CENTER_H

#include <rbsim/model.h>

#include "math/quat.h"
#include "math/vec3.h"

/* Centre of mass of moving body `index`, m, world axes, from the origin of its shape. */
static inline rb_vec3 rb_model_center(const struct rb_model *model, int index, rb_vec3 origin,
                                      rb_quat orientation)
{
	if (!model->center_of_mass)
		return origin;
	return rb_vec3_add(origin, rb_quat_rotate(orientation, model->center_of_mass[index]));
}

/* Origin of the shape of moving body `index`, m, world axes, from its centre of mass. */
static inline rb_vec3 rb_model_origin(const struct rb_model *model, int index, rb_vec3 center,
                                      rb_quat orientation)
{
	if (!model->center_of_mass)
		return center;
	return rb_vec3_sub(center, rb_quat_rotate(orientation, model->center_of_mass[index]));
}

#endif
