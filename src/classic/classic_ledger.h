/* SPDX-License-Identifier: MIT */
/*
 * What the classic method enters in the ledger. All impulses of a substep act together, so each
 * does its work at the mean of the velocities before the substep's forces and after its reactions;
 * those of impacts at the mean of before and after their round. Nothing is done where the ledger is
 * not kept.
 */
#ifndef RB_CLASSIC_CLASSIC_LEDGER_H
#define RB_CLASSIC_CLASSIC_LEDGER_H

#include "constraint/impulse.h"
#include "step/stage.h"

/* A substep that was accepted, while pass->now is of its beginning; `before`: the state then. */
void rb_classic_ledger_substep(struct rb_pass *pass, const struct rb_state *before);

/*
 * An impact; `before`: the relative velocity at the beginning of its round, the state is that after
 * it.
 */
void rb_classic_ledger_impact(struct rb_pass *pass, const struct rb_link *link, rb_vec3 impulse,
                              rb_vec3 before);

#endif
