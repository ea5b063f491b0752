/* SPDX-License-Identifier: MIT */
/*
 * Rims that roll and come to lie flat. The lowest point of a rim is a smooth function of how it is
 * tilted, but not where the tilt is nothing: there it is on the other side at once. So a piece
 * keeps to the half of the rim on which it began (rb_feature_half); where the rim has gone through
 * flat, another point of it is below, which is a hit like any other.
 */
#ifndef RB_LOCATED_RIM_LANDING_H
#define RB_LOCATED_RIM_LANDING_H

#include "located/modes.h"

/*
 * At the beginning of a piece: the halves that it keeps to. True: a rim comes to lie flat at once,
 * all but exactly, and the cluster has an impact. Its lowest point would run round it in times as
 * short as what is left of its tilt, of which rounding leaves few digits; the other side of it
 * touches as far as anybody can say.
 */
bool rb_rim_landing_begin(struct rb_modes *w);

#endif
