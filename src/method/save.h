/* SPDX-License-Identifier: MIT */
/*
 * Packs all state of a world that determines its future (base/pack). Simulator's thread.
 *
 * Call between frames, after the frame was filled. Loading requires a new world of the same model
 * with the same options, except threads. A world that failed to load can only be destroyed.
 */
#ifndef RB_METHOD_SAVE_H
#define RB_METHOD_SAVE_H

#include <rbsim/world.h>

#include "base/pack.h"

/* Approximate number of bytes, for allocating them beforehand. */
size_t rb_world_pack_guess(const struct rb_world *world);
/* RB_ERR_INPUT: the bytes are not those of such a world; RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_world_pack(struct rb_world *world, struct rb_pack *pack,
                                        struct rb_error *err);

#endif
