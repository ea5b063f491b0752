/* SPDX-License-Identifier: MIT */
/*
 * Rolling rims that come to lie flat. The lowest point of a rim is a smooth function of its tilt
 * except at zero tilt, where it jumps to the other side. So a piece follows the half of the rim on
 * which it began (rb_feature_half); when the rim has passed through flat, another point of it is
 * below, which is an impact like any other.
 */
#ifndef RB_LOCATED_RIM_LANDING_H
#define RB_LOCATED_RIM_LANDING_H

#include "located/modes.h"

/*
 * Sets, at the beginning of a piece, the halves that it follows. True: a rim is about to lie flat,
 * to rounding, and the cluster has an impact. Its lowest point would move around it in times as
 * short as the remaining tilt, of which rounding leaves few digits; its other side touches to
 * rounding.
 */
bool rb_rim_landing_begin(struct rb_modes *w);

#endif
