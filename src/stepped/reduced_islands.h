/* SPDX-License-Identifier: MIT */
/*
 * The step of groups that joints alone hold, whose joints form trees and move freely, under
 * constant forces.
 *
 * They need no rows: stepped/reduced_step takes the step by what their joints leave free. A group
 * that it does not resolve takes rows (islands), and so does one whose masses are so unequal that
 * articulated inertias lose half of their digits.
 *
 * Any worker, one group each; the solver's rows of its bodies and joints.
 */
#ifndef RB_STEPPED_REDUCED_ISLANDS_H
#define RB_STEPPED_REDUCED_ISLANDS_H

#include "stepped/islands.h"

/*
 * Tries to step the group, whose members and joints are known. True: it is done, and no gap of its
 * points has closed at the end. Where its bodies end is in solver->swung, velocities are in its
 * bodies, what joints exert in theirs.
 */
rb_swing rb_reduced_islands_try;

#endif
