/* SPDX-License-Identifier: MIT */
/* Parts of a method, as listed by `rbsim check`, and whether a scene needs them; one row each. */
#ifndef RB_STEP_METHOD_PART_H
#define RB_STEP_METHOD_PART_H

#include <rbsim/model.h>

struct rb_method_part {
	const char *name, *what;
	rb_features need; /* any of these; 0: always */
};

bool rb_method_part_is_used(const struct rb_method_part *part, const struct rb_model *model);
/* Why a part is left out; "" where it is used. */
const char *rb_method_part_why_not(const struct rb_method_part *part, const struct rb_model *model);

#endif
