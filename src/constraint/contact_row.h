/* SPDX-License-Identifier: MIT */
/*
 * A contact as a constraint: the row follows from the bodies' materials and the geometry of the
 * point. Pure functions.
 */
#ifndef RB_CONSTRAINT_CONTACT_ROW_H
#define RB_CONSTRAINT_CONTACT_ROW_H

#include <rbsim/model.h>

#include "constraint/row.h"

/* Returns friction and restitution between two bodies, given by index. */
static inline const struct rb_pair_material *rb_contact_material(const struct rb_model *model,
                                                                 int a, int b)
{
	return &model->pair_materials[model->material[a] * model->material_count +
	                              model->material[b]];
}

/* Returns the row of a contact, with arms as vectors; solvers fill the other fields. */
static inline struct rb_constraint rb_contact_row(int a, int b, rb_vec3 normal, rb_vec3 arm_a,
                                                  rb_vec3 arm_b, double friction)
{
	return (struct rb_constraint){.a = a,
	                              .b = b,
	                              .set = RB_CONSTRAINT_CONE,
	                              .normal = normal,
	                              .arm_a = arm_a,
	                              .arm_b = arm_b,
	                              .friction = friction};
}

#endif
