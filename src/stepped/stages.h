/* SPDX-License-Identifier: MIT */
/* What a step of the stepped method does, in order, for `rbsim check`: one row each. */
#ifndef RB_STEPPED_STAGES_H
#define RB_STEPPED_STAGES_H

#include "step/method_part.h"

const struct rb_method_part *rb_stepped_parts(int *count);

#endif
