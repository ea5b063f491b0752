/* SPDX-License-Identifier: MIT */
/*
 * Pairs of bodies that touch at more points than they have degrees of freedom: the distribution of
 * the normal impulses over the points is indeterminate, and where they slide, friction depends on
 * it. Of all normal impulses with the same effect on the bodies, those of least norm have the
 * symmetry of the bodies, whatever the order of the points. Joints transmit loads: the loads of a
 * body's four wheels are indeterminate as well.
 */
#ifndef RB_STEPPED_REDUNDANT_CONTACTS_H
#define RB_STEPPED_REDUNDANT_CONTACTS_H

#include "base/arena.h"
#include "constraint/row.h"

/*
 * Replaces the normal impulses of pairs that slide at some point (with joints: of all pairs, if one
 * slides) by the non-negative ones of least norm; sliding friction changes with them. Without
 * joints they close the gaps, and where targets of a pair contradict each other by no more than
 * `slack`, m/s, in a way in which points of one rigid body cannot move, these are replaced by the
 * nearest consistent ones; a negative `slack` leaves out contacts without an impulse and keeps
 * targets. Returns true if something has changed by more than `tolerance`, m/s, and
 * is to be solved again. Systems that would take more than `max` multiplications are left
 * unchanged.
 */
bool rb_redundant_contacts(const struct rb_row_system *rows, double tolerance, double slack,
                           double max, struct rb_arena *arena);

#endif
