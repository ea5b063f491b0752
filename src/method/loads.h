/* SPDX-License-Identifier: MIT */
/*
 * Forces on bodies and their accelerations at the present time, on demand: nothing is allocated
 * before the first call, and the simulation's state does not change. Simulator's thread.
 *
 * External forces are those of located/external_force. Contact forces are the present ones while
 * motion is located, else means over the last step. Before the first step they come from a separate
 * world that takes that step.
 */
#ifndef RB_METHOD_LOADS_H
#define RB_METHOD_LOADS_H

#include "world/world.h"

/*
 * Sets the initial velocities of driven bodies whose functions give none to the derivatives at time
 * 0. If a function has none there, the run reports it when it gets there.
 */
RB_CHECKED enum rb_status rb_loads_start_driven(struct rb_world *world, struct rb_error *err);

void rb_loads_destroy(struct rb_loads *loads); /* NULL is fine */

#endif
