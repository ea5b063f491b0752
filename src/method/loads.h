/* SPDX-License-Identifier: MIT */
/*
 * What acts on bodies at a moment, for who asks: nothing of it exists until then, and nothing of
 * the run changes.
 *
 * Forces are those of located/external_force; of contacts those of this very moment where motion is
 * located, else the mean over the step that has ended. Before the first step a world of its own
 * looks what would become of the beginning.
 */
#ifndef RB_METHOD_LOADS_H
#define RB_METHOD_LOADS_H

#include "world/world.h"

/*
 * Velocities that functions of driven bodies do not give are those that lead on from time 0: of
 * what `world` starts with. Where a function does not lead on it says so when the run comes there.
 */
RB_CHECKED enum rb_status rb_loads_start_driven(struct rb_world *world, struct rb_error *err);

void rb_loads_destroy(struct rb_loads *loads); /* NULL is fine */

#endif
