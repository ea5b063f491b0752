/* SPDX-License-Identifier: MIT */
/*
 * Why a piece of a cluster cannot be integrated, as a message that names what is to be changed.
 * Each returns false where it is not its case; else l->status says why.
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
