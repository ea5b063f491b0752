/* SPDX-License-Identifier: MIT */
/* How much locating may cost. Simulator thread. */
#ifndef RB_LOCATED_ALLOWANCE_H
#define RB_LOCATED_ALLOWANCE_H

#include "located/located.h"

/*
 * Bodies of crowds that a second allows, 1/s, from arcs that begin with the world's state: about
 * what steps would cost. A body that falls or flies by its own size allows PACE_BODY, as do
 * PACE_AT_REST bodies together that stand on their arcs; the fastest allows PACE_WORLD beside, of
 * more than PACE_FEW bodies a share: few are worth locating. What joints hold has the speed at
 * which it passes what it is joined to, and each of its joints allows half as much again. Neither
 * seconds nor time_step are in it, so that scenes of other units are located alike. Where nothing
 * moves nor weighs, as of springs that are let go, a run allows PACE_RUN times as many. After steps
 * it is no more than these have cost, were nobody at rest.
 */
double rb_located_pace(const struct rb_located *l);

#endif
