/* SPDX-License-Identifier: MIT */
/* Names of the limits that fields of a world's state have (base/field_list). */
#ifndef RB_WORLD_LIMITS_H
#define RB_WORLD_LIMITS_H

#include <rbsim/model.h>

#include "base/field_list.h"

enum rb_limit {
	RB_LIMIT_BODY = 1,   /* index of a body that moves */
	RB_LIMIT_ANY_BODY,   /* index of a body, which may be static */
	RB_LIMIT_ID,         /* id of a body */
	RB_LIMIT_NEXT_FREE,  /* 1 + index of a cluster of the located method */
	RB_LIMIT_NEXT_JOINT, /* 1 + number of a joint */
	RB_LIMIT_SWITCH,     /* count of moments at which forces begin or end */
	RB_LIMIT_COUNT
};

struct rb_limits {
	int high[RB_LIMIT_COUNT];
};

/* Those that the model says; the located method's are zero. */
static inline struct rb_limits rb_limits_of(const struct rb_model *model)
{
	const int all = model->body_count + model->static_count;

	return (struct rb_limits){.high = {
					  [RB_LIMIT_BODY] = model->body_count - 1,
					  [RB_LIMIT_ANY_BODY] = all - 1,
					  [RB_LIMIT_ID] = all - 1,
					  [RB_LIMIT_NEXT_JOINT] = model->scene->joint_count,
				  }};
}

#endif
