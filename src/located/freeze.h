/* SPDX-License-Identifier: MIT */
/*
 * All of the located method that decides the future, to bytes and back: the same bits follow as if
 * nothing had been.
 *
 * What is foreseen is kept as it is: foreseen again from another moment, it could come out one
 * rounding apart.
 */
#ifndef RB_LOCATED_FREEZE_H
#define RB_LOCATED_FREEZE_H

#include "base/pack.h"
#include "located/located.h"

/*
 * Between frames. Loading: into one that was just made for the same model; of no use after a
 * failure.
 */
void rb_freeze_pack(struct rb_located *l, struct rb_pack *pack);

#endif
