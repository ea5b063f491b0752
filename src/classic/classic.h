/* SPDX-License-Identifier: MIT */
/*
 * The classic method: the project as first described, and a baseline for `rbsim converge`.
 *
 * Equations. Semi-implicit Euler in a substep h: v' = v + h a, then reactions, x' = x + h v'. A
 * reaction is the impulse within the friction cone that keeps the gap at the end of the substep
 * from closing; an impact follows an accepted substep, with v_n' = -e v_n on the approach without
 * what forces of this substep added to it (constraint/impulse).
 *
 * One step:
 *
 *     pairs within reach ---> groups; who is alone flies in blocks    (groups)
 *                                |  each group on its own, in parallel by groups
 *        try a substep <---------+                                    (stage_list)
 *          |
 *        finite, overlap within the tolerance? --no--> back, half the substep   (rollback)
 *          |yes                                           below 2^-60 of the step: status 76
 *        impacts at its end, the rest of the step is tried again      (impact)
 *          |
 *        path beyond the group's reach? --yes--> groups are merged, both run again
 *          |no
 *        commit: contacts and events in order of time and pair
 *
 * Constants: 2^-60 of a step and 20 million attempts end a rollback (rollback.c); fat boxes last
 * about eight steps (step/broadphase).
 */
#ifndef RB_CLASSIC_CLASSIC_H
#define RB_CLASSIC_CLASSIC_H

#include "model/descriptor.h"
#include "world/world.h"

extern const struct rb_method rb_method_classic;

#endif
