/* SPDX-License-Identifier: MIT */
/*
 * One step of the classic method: groups, every group on its own through classic/rollback (in
 * parallel, split by groups, never by workers), merges until no path was missed, commit: contacts
 * and events in order of time and pair.
 */
#ifndef RB_CLASSIC_CLASSIC_H
#define RB_CLASSIC_CLASSIC_H

#include "world/world.h"

/* What the method needs beside the state; made when it is first used. */
RB_CHECKED enum rb_status rb_classic_prepare(struct rb_world *world, struct rb_error *err);

/* On failure the state is that of the beginning of the step. */
RB_CHECKED enum rb_status rb_classic_step(struct rb_world *world, double start_s, double dt_s,
                                          struct rb_error *err);

#endif
