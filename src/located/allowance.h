/* SPDX-License-Identifier: MIT */
/* Limit of the cost of locating. Simulator's thread. */
#ifndef RB_LOCATED_ALLOWANCE_H
#define RB_LOCATED_ALLOWANCE_H

#include "located/located.h"

/*
 * Work that a second allows, in bodies per s, for arcs that begin with the world's state: about the
 * cost of steps. A body that falls or flies by its own size allows PACE_BODY, as do PACE_AT_REST
 * bodies at rest together; the fastest one allows PACE_WORLD in addition, or with more than
 * PACE_FEW bodies a share of it: few bodies are worth locating. A body held by joints counts with
 * its speed relative to the bodies it is joined to, and each of its joints allows half as much
 * again. Neither seconds nor time_step enter, so that scenes in other units are located alike. If
 * nothing moves or has weight, as with springs at release, a run allows PACE_RUN times as much.
 * After steps the limit is at most what these have cost, had no body been at rest.
 */
double rb_located_pace(const struct rb_located *l);

#endif
