/* SPDX-License-Identifier: MIT */
/* The stepped method, and what a step of it does, in order: one row each. */
#ifndef RB_STEPPED_STAGES_H
#define RB_STEPPED_STAGES_H

#include "model/descriptor.h"
#include "step/method_part.h"

extern const struct rb_method rb_method_stepped;

#endif
