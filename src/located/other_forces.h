/* SPDX-License-Identifier: MIT */
/*
 * Other forces than those that an elimination found, where the modes leave forces open: for the
 * same motion within the law; or, where rows contradict each other, for any motion.
 */
#ifndef RB_LOCATED_OTHER_FORCES_H
#define RB_LOCATED_OTHER_FORCES_H

#include "located/modes.h"

/* Relative difference of accelerations between two solutions for the same motion. */
#define RB_OTHER_FORCES_SAME 1e-10

/*
 * If modes leave forces open, those that were found may be outside the cones while others are
 * within: are there lawful forces with the same motion of all bodies? If so, these become the
 * forces.
 */
bool rb_other_forces_hold(struct rb_modes *w, double t);

/*
 * Do stops that hold, and joints, contradict each other at these values, whatever their forces, as
 * ropes of a straight chain between fixed ends that loads push across? Then a stop that lets go is
 * hit again at once. False where contacts, motors or friction may give way. Leaves other forces and
 * accelerations.
 */
bool rb_other_forces_contradict(struct rb_modes *w, double t, const double *value);

#endif
