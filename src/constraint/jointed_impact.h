/* SPDX-License-Identifier: MIT */
/*
 * Impact of a single contact of bodies that joints hold: the same law as that of free bodies
 * (constraint/impulse), with the inverse effective mass of the linkage,
 *
 *     K = J (M^-1 - M^-1 G^T (G M^-1 G^T)^+ G M^-1) J^T
 *
 * J: rows of the contact, G: of the joints, which transmit whatever keeps their velocities. Columns
 * of K are the responses of the linkage to unit impulses at the contact. K may be singular: a
 * pendulum's tip moves along one direction only. So what is hinged to a body by next to no mass
 * does not change its impacts.
 */
#ifndef RB_CONSTRAINT_JOINTED_IMPACT_H
#define RB_CONSTRAINT_JOINTED_IMPACT_H

#include "constraint/cone.h"
#include "constraint/impulse.h"

/* Whether a joint's row keeps its velocity whatever impulse that takes. */
bool rb_jointed_impact_is_bilateral(const struct rb_cone_row *row);

/*
 * Resolves the impact. `cone`: an open problem with the bilateral rows of the linkages at both
 * sides, and no others, without impulses. `link`: bodies, normal, arms, friction and restitution of
 * the contact. `velocity`: that of the contact before, m/s, approaching. Out: the impulse on b,
 * N s; velocities of the bodies and impulses of the rows. False: the joints cannot be satisfied, or
 * the contact would approach by more than `noise`, m/s, afterwards; nothing has changed. Scratch is
 * the cone's, and lives as long.
 */
bool rb_jointed_impact(struct rb_cone *cone, const struct rb_link *link, rb_vec3 velocity,
                       double noise, rb_vec3 *impulse);

#endif
