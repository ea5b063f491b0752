/* SPDX-License-Identifier: MIT */
/*
 * What holds of a world's rows between steps. Pure functions; simulator thread.
 *
 * RB_ERR_BUG says what does not. rb_world_validate (method/method) asks for all of it, after every
 * frame of debug and sanitizer builds.
 */
#ifndef RB_WORLD_INVARIANTS_H
#define RB_WORLD_INVARIANTS_H

#include "world/world.h"

/* Finite rows, quaternions of unit length. */
RB_CHECKED enum rb_status rb_validate_state(const struct rb_world *world, struct rb_error *err);

/* Contacts sorted by pair, of bodies that there are, with unit normals and forces that push. */
RB_CHECKED enum rb_status rb_validate_contacts(const struct rb_world *world,
                                               const struct rb_contacts *contacts,
                                               struct rb_error *err);

/* Events in order of time, of bodies that there are; finite sums of the ledger. */
RB_CHECKED enum rb_status rb_validate_records(const struct rb_world *world, struct rb_error *err);

#endif
