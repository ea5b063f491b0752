/* SPDX-License-Identifier: MIT */
/*
 * The stepped method, for groups with too many events to locate one by one.
 *
 * One step: forces; points of all pairs that could touch within it (stepped/contact_points); groups
 * that touch, each solved for impulses that leave no overlap at the end of the step (stepped/row)
 * until its residual is below what the tolerance asks for; positions move with those velocities,
 * then impacts rebound; what turning bodies have left of overlap is closed by moving positions
 * only; the verdict; else back, and half the step.
 */
#ifndef RB_STEPPED_STEPPED_H
#define RB_STEPPED_STEPPED_H

#include "base/pack.h"
#include "world/world.h"

struct rb_stepped;

/* What the method needs beside the state; made when it is first used. */
RB_CHECKED enum rb_status rb_stepped_prepare(struct rb_world *world, struct rb_error *err);
void rb_stepped_destroy(struct rb_stepped *stepped); /* NULL is fine */

/*
 * Before the first step after another method: it starts from the forces of the contacts that this
 * has left.
 */
RB_CHECKED enum rb_status rb_stepped_take_over(struct rb_world *world, struct rb_error *err);

/* On failure the state is that of the beginning of the step. */
RB_CHECKED enum rb_status rb_stepped_step(struct rb_world *world, double start_s, double dt_s,
                                          struct rb_error *err);

/* What the next step starts from, to bytes and back; made when it is loaded. */
void rb_stepped_pack(struct rb_world *world, struct rb_pack *pack);

#endif
