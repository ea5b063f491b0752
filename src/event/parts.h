/* SPDX-License-Identifier: MIT */
/* Which parts of the located method a scene needs, for `rbsim check`: one row each. */
#ifndef RB_EVENT_PARTS_H
#define RB_EVENT_PARTS_H

#include <rbsim/model.h>

struct rb_part {
	const char *name, *what;
	rb_features need; /* any of these; 0: always */
};
const struct rb_part *rb_parts(int *count);
bool rb_part_is_used(const struct rb_part *part, const struct rb_model *model);
/* Why a part is left out; "" where it is used. */
const char *rb_part_why_not(const struct rb_part *part, const struct rb_model *model);

#endif
