/* SPDX-License-Identifier: MIT */
/* What a step of the stepped method does, in order, for `rbsim check`: one row each. */
#ifndef RB_STEPPED_STAGES_H
#define RB_STEPPED_STAGES_H

#include "event/parts.h"

const struct rb_part *rb_stepped_stages(int *count);

#endif
