/* SPDX-License-Identifier: MIT */
/*
 * Which touching bodies approach, and what becomes of them.
 *
 * Runs on pass->now after an accepted substep, and once before the first. Touching, approaching and
 * separating are told apart by gap and normal velocity. Of the approach, the part that the forces
 * of this very substep have added counts for stopping it but not for restitution, so that a resting
 * ball does not bounce on g h. In a crowd (a body that already rests on another) an approach no
 * faster than what the forces along the normal, of a lasting contact its own, make in one whole
 * step is stopped, not reflected: this ends the small impacts of a heap, and goes to zero with the
 * step. All pairs that approach at the same moment are solved together; those that come to approach
 * by that follow in the next round, and so an impact passes through a touching row. A round that
 * would raise kinetic energy (several contacts with friction) is taken back and done pair by pair.
 */
#ifndef RB_CLASSIC_IMPACT_H
#define RB_CLASSIC_IMPACT_H

#include "step/stage.h"

/*
 * True if any velocity was changed. Events of impacts are kept in the pass; `after_substep` false:
 * at the beginning.
 */
bool rb_impact_resolve(struct rb_pass *pass, bool after_substep);

#endif
