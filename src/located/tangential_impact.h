/* SPDX-License-Identifier: MIT */
/*
 * For located/resolve_contacts: slips that no force allows. Where friction at its limit presses
 * harder together than the contact yields, and the other forces press, too, no finite force keeps
 * the bodies apart (Painleve; Genot, Brogliato, Eur. J. Mech. A 18 (1999) 653): slip ends at that
 * moment by an impulse, that of an impact that begins without an approach.
 */
#ifndef RB_LOCATED_TANGENTIAL_IMPACT_H
#define RB_LOCATED_TANGENTIAL_IMPACT_H

#include "located/slips.h"

/*
 * `s` is solved, and its roots are joined. True: there was one, bodies have other velocities, and
 * are to be resolved anew, as after an impact. One pair alone follows the law of
 * constraint/eccentric, with its restitution, several points of it as one in their middle; of
 * several pairs all points are stopped, where that is within their cones, and give nothing back.
 * Where neither is possible impulses along the forces end the first of the slips.
 * What is so slow that any force would stop it within rounding of places is stopped at once.
 */
bool rb_tangential_impact(struct rb_resolution *s);

/*
 * The contact that such an impulse, at another point of the pair, has made to approach most, beyond
 * rounding: an impact; -1: none.
 */
int rb_tangential_impact_hit(const struct rb_resolution *s);

#endif
