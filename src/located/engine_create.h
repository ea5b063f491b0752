/* SPDX-License-Identifier: MIT */
/*
 * Creation and destruction of the located method's state. Owned by the world; simulator's thread
 * only.
 */
#ifndef RB_LOCATED_ENGINE_CREATE_H
#define RB_LOCATED_ENGINE_CREATE_H

#include "located/located.h"
#include "model/descriptor.h"

/* Creates it from the world's state at the start. The first advance makes arcs and predicts. */
RB_CHECKED enum rb_status rb_engine_create(struct rb_located **made, struct rb_world *world,
                                           struct rb_error *err);
void rb_engine_destroy(struct rb_located *l); /* NULL is fine */

/* True if the scene's method may change to steps. */
static inline bool rb_located_can_be_stepped(const struct rb_located *l)
{
	return rb_model_may_change_method(l->model) &&
	       (l->model->features & (RB_FEATURE_CONTACT | RB_FEATURE_JOINTS));
}

#endif
