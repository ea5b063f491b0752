/* SPDX-License-Identifier: MIT */
/*
 * The stepped method's row in the table of methods, and the stages of its step, in order, one row
 * each.
 */
#ifndef RB_STEPPED_STAGES_H
#define RB_STEPPED_STAGES_H

#include "model/descriptor.h"
#include "step/method_part.h"

extern const struct rb_method rb_method_stepped;

#endif
