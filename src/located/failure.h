/* SPDX-License-Identifier: MIT */
/*
 * Error messages for pieces of a cluster that cannot be integrated, which name what to change. Each
 * function returns false if its case does not apply; otherwise it sets l->status.
 */
#ifndef RB_LOCATED_FAILURE_H
#define RB_LOCATED_FAILURE_H

#include "located/modes.h"

/* Velocities, or accelerations just evaluated, whose squares are not finite. */
bool rb_failure_by_size(const struct rb_modes *w);
bool rb_failure_by_collision(const struct rb_modes *w);
bool rb_failure_by_lock(const struct rb_modes *w);
bool rb_failure_by_joints(const struct rb_modes *w, const char *why);

#endif
