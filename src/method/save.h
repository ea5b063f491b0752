/* SPDX-License-Identifier: MIT */
/*
 * All of a world that decides its future, to bytes and back (base/pack).
 *
 * Between frames, after the frame was filled. Loading: into a world that was just made for the same
 * model with the same options, threads apart. A world that failed to load is only to be destroyed.
 */
#ifndef RB_METHOD_SAVE_H
#define RB_METHOD_SAVE_H

#include <rbsim/world.h>

#include "base/pack.h"

/* About how many bytes that will be, for room to be found beforehand. */
size_t rb_world_pack_guess(const struct rb_world *world);
/* RB_ERR_INPUT: the bytes are not those of such a world; RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_world_pack(struct rb_world *world, struct rb_pack *pack,
                                        struct rb_error *err);

#endif
