/* SPDX-License-Identifier: MIT */
/*
 * For located/resolve_contacts: slips that no force allows. If friction at its limit presses the
 * bodies together more than the normal force separates them, and the other forces press them
 * together, too, no finite force prevents penetration (Painleve; Genot, Brogliato, Eur. J. Mech. A
 * 18 (1999) 653): slip ends at that moment by an impulse, that of an impact without an approach.
 */
#ifndef RB_LOCATED_TANGENTIAL_IMPACT_H
#define RB_LOCATED_TANGENTIAL_IMPACT_H

#include "located/slips.h"

/*
 * `s` is solved, and its roots are joined. True: there was such an impulse; velocities have
 * changed, and contacts must be resolved anew, as after an impact. A single pair follows the law of
 * constraint/eccentric, with its restitution, several points of it as one at their centre; for
 * several pairs all points are stopped without restitution, if that is within their cones. If
 * neither is possible, impulses along the forces end the first of the slips. Slips so slow that any
 * force would stop them within rounding of positions are stopped at once.
 */
bool rb_tangential_impact(struct rb_resolution *s);

/*
 * Returns the contact that approaches most, beyond rounding, because of such an impulse at another
 * point: an impact; -1: none.
 */
int rb_tangential_impact_hit(const struct rb_resolution *s);

#endif
