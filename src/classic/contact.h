/* SPDX-License-Identifier: MIT */
/*
 * Lasting contact: which pairs are in it, and the reactions, after all other forces.
 *
 * A touching pair whose normal speed cannot open the gap beyond the touching band under the present
 * forces is in lasting contact; that is the only rest rule for a body on its own. In a crowd, where
 * a body already rests on another one, two more things follow for steps of finite length, and both
 * go to zero with the step: a pair that the forces bring together within the step, no faster than
 * they can from rest in one step, is in contact at its end ("soft landing": of the many small
 * impacts in a settling heap there is nothing left to reflect, see classic/impact); and a pair
 * stays in contact while no faster gap opens between them than the curvature of their paths
 * explains. Reactions are impulses that keep the gap at the end of the substep from closing, within
 * the friction cone.
 */
#ifndef RB_CLASSIC_CONTACT_H
#define RB_CLASSIC_CONTACT_H

#include "constraint/impulse.h"

extern const struct rb_stage rb_stage_look_ahead;
extern const struct rb_stage rb_stage_reactions;

/*
 * Change of velocity at which iteration over resting contacts stops: it moves a body by a small
 * share (1e-3) of the tolerance in a whole step, m/s.
 */
double rb_contact_tolerance(const struct rb_pass *pass);

/* Does one of the two rest on something, as of the beginning of the substep? */
bool rb_contact_crowded(const struct rb_pass *pass, const struct rb_touch *touch);

/*
 * Speed along the normal that what has changed the velocities in this substep would give the two
 * bodies, each on its own, in a whole step, m/s.
 */
double rb_contact_forced(const struct rb_pass *pass, const struct rb_link *link);

/*
 * At the end of a step: overlaps of lasting contacts (they are within the tolerance) are halved by
 * moving positions only, so that what rests comes to rest just touching. Not done where it would
 * deepen another contact.
 */
void rb_contact_resolve(struct rb_pass *pass);

/* Takes over the lasting contacts of the step before (or none), at the beginning of a step. */
void rb_contact_begin(struct rb_pass *pass);

#endif
