/* SPDX-License-Identifier: MIT */
/*
 * Pairs that touch at more points than there are freedoms: which of them bears how much is open,
 * and where they slide friction follows it. Of all normal impulses that do the same to the bodies
 * the smallest have the symmetry of the bodies, whatever the order of points. Joints hand loads on:
 * what a body on four wheels presses on each of them is open as well.
 */
#ifndef RB_STEPPED_REDUNDANT_CONTACTS_H
#define RB_STEPPED_REDUNDANT_CONTACTS_H

#include "base/arena.h"
#include "constraint/row.h"

/*
 * Pushes of pairs that slide somewhere (with joints: of all pairs, if one does) become those of the
 * smallest squares of which none is negative; friction that slides goes with them. Without joints
 * they close the gaps, and where targets of a pair contradict each other by no more than `slack`,
 * m/s, as points of one rigid body cannot move, these become what is nearest to all. True:
 * something has changed by more than `tolerance`, m/s, and is to be solved again. What would take
 * more than `max` multiplications is left as it is.
 */
bool rb_redundant_contacts(const struct rb_row_system *rows, double tolerance, double slack,
                           double max, struct rb_arena *arena);

#endif
