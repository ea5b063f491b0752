/* SPDX-License-Identifier: MIT */
/*
 * Steps islands whose joints form trees and move freely, under constant forces and drag, in reduced
 * coordinates.
 *
 * They need no rows: stepped/reduced_step. An island that it does not resolve takes rows (islands),
 * and so does one whose masses are so unequal that articulated inertias lose half of their digits.
 *
 * Any worker, one island each; the solver's rows of its bodies and joints.
 */
#ifndef RB_STEPPED_REDUCED_ISLANDS_H
#define RB_STEPPED_REDUCED_ISLANDS_H

#include "stepped/islands.h"

/*
 * Tries to step the island, whose members and joints are known. True: done, and no gap of its
 * points has closed at the end. Poses are then in solver->reduced_motion, velocities in its bodies,
 * loads of joints in these.
 */
rb_reduced_stepper rb_reduced_islands_try;

#endif
