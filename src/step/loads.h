/* SPDX-License-Identifier: MIT */
/*
 * What acts on bodies at a moment, for who asks: nothing of it exists until then, and nothing of the run changes.
 *
 * Forces are those of event/pull; of contacts those of this very moment where motion is located, else the mean over the step
 * that has ended. Before the first step a world of its own looks what would become of the beginning.
 */
#ifndef RB_STEP_LOADS_H
#define RB_STEP_LOADS_H

#include "world/world.h"

void rb_loads_destroy(struct rb_loads *loads); /* NULL is fine */

#endif
