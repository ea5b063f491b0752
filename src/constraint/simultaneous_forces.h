/* SPDX-License-Identifier: MIT */
/* Forces of lasting contacts, solved together (constraint/simultaneous). */
#ifndef RB_CONSTRAINT_SIMULTANEOUS_FORCES_H
#define RB_CONSTRAINT_SIMULTANEOUS_FORCES_H

#include "constraint/simultaneous.h"

/*
 * Finds the forces of lasting contacts and joints, starting from their impulses as guesses:
 * relative normal acceleration >= 0, force >= 0, complementary; a sticking contact has no relative
 * tangential acceleration unless its friction is at the cone (then opposite to the acceleration); a
 * sliding one has friction * force opposite to its slip. Adds the accelerations by the forces to
 * the bodies. Accelerations are accurate to about 1e-13 of the largest one in the problem, even if
 * the forces are not unique (touching lattices). Returns the largest remaining violation, m/s^2;
 * INFINITY if out of memory. If no solution with the whole friction is found (jammed bodies, mostly
 * with friction near 1 and above), slipping contacts get less.
 */
double rb_simultaneous_forces(struct rb_simultaneous *problem);

#endif
