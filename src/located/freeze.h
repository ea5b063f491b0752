/* SPDX-License-Identifier: MIT */
/*
 * Packs all state of the located method that determines its future: a run continued from it gives
 * the same bits as one that was not interrupted. Simulator's thread.
 *
 * Predictions are saved as they are: predicted again from another time, they could differ by
 * rounding.
 */
#ifndef RB_LOCATED_FREEZE_H
#define RB_LOCATED_FREEZE_H

#include "base/pack.h"
#include "located/located.h"

/*
 * Call between frames. Loading requires a new object of the same model, which is unusable after a
 * failure.
 */
void rb_freeze_pack(struct rb_located *l, struct rb_pack *pack);

#endif
