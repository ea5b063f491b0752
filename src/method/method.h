/* SPDX-License-Identifier: MIT */
/*
 * Runs the plan for one frame; makes and unmakes worlds (<rbsim/world.h>).
 *
 * A frame interval takes equal steps of at most time_step. One step: hooks, groups, every group on
 * its own through classic/rollback (in parallel, split by groups, never by workers), merges until
 * no path was missed, commit: contacts and events in order of time and pair.
 */
#ifndef RB_METHOD_METHOD_H
#define RB_METHOD_METHOD_H

#include "world/world.h"

/*
 * Steps that an interval takes: ceil(interval / time_step), a quotient within a few ulp of a whole
 * number being it.
 */
int64_t rb_step_count(double interval_s, double time_step_s);
/*
 * What must hold of a world between frames, all of it: rows, contacts, records, and the state of
 * the methods that it has. RB_ERR_BUG says what does not. After every frame of debug and sanitizer
 * builds.
 */
RB_CHECKED enum rb_status rb_world_validate(const struct rb_world *world, struct rb_error *err);
/* Of the interval between two frames of the model, or what there is of one at the run's end. */
int64_t rb_frame_step_count(const struct rb_model *model, double begin_s, double end_s);

#endif
