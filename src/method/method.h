/* SPDX-License-Identifier: MIT */
/*
 * Creates and destroys worlds, and runs them frame by frame (<rbsim/world.h>). Simulator's thread.
 *
 * A frame interval takes equal steps of at most time_step. One step calls on_step and then the
 * scene's method (model/descriptor). `auto` locates, and steps while that is too costly or fails.
 */
#ifndef RB_METHOD_METHOD_H
#define RB_METHOD_METHOD_H

#include "world/world.h"

/*
 * Number of steps of an interval: ceil(interval / time_step), where a quotient within a few ulp of
 * an integer counts as that integer.
 */
int64_t rb_step_count(double interval_s, double time_step_s);
/*
 * Checks all invariants of a world between frames: rows, contacts, records, and the state of its
 * methods. The message of RB_ERR_BUG names the violated one. Called after every frame of debug and
 * sanitizer builds.
 */
RB_CHECKED enum rb_status rb_world_validate(const struct rb_world *world, struct rb_error *err);
/*
 * Number of steps of the interval between two frames of the model, or of a shorter one at the run's
 * end.
 */
int64_t rb_frame_step_count(const struct rb_model *model, double begin_s, double end_s);

#endif
