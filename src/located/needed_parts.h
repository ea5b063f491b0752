/* SPDX-License-Identifier: MIT */
/* Which parts of the located method a scene needs, for `rbsim check`: one row each. */
#ifndef RB_LOCATED_NEEDED_PARTS_H
#define RB_LOCATED_NEEDED_PARTS_H

#include "step/method_part.h"

const struct rb_method_part *rb_located_parts(int *count);

#endif
