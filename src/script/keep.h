/* SPDX-License-Identifier: MIT */
/*
 * What a script remembers across a checkpoint, to bytes and back (base/pack): the table `state`,
 * where its random numbers stand, and how each expect_always has gone so far.
 *
 * `state` holds texts, numbers, booleans, vectors, bodies, and tables of these. A table that is
 * there twice is the same table afterwards, circles too; the tables that the scene has made for
 * `state` while it was loaded stay the same ones, so that its own names for them hold. Simulator's
 * thread.
 */
#ifndef RB_SCRIPT_KEEP_H
#define RB_SCRIPT_KEEP_H

#include "base/pack.h"
#include "script/script.h"

/*
 * Saving, RB_ERR_SCENE names what in `state` can't be kept: `state.ball.launch: a function can't be
 * kept ...`. Loading, RB_ERR_INPUT.
 */
RB_CHECKED enum rb_status rb_script_pack(struct rb_script *script, struct rb_pack *pack,
                                         struct rb_error *err);

#endif
