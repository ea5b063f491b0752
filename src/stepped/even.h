/* SPDX-License-Identifier: MIT */
/*
 * Pairs that touch at more points than there are freedoms: which of them bears how much is open,
 * and where they slide friction follows it. Of all normal impulses that do the same to the bodies
 * the smallest have the symmetry of the bodies, whatever the order of points.
 */
#ifndef RB_STEPPED_EVEN_H
#define RB_STEPPED_EVEN_H

#include "base/arena.h"
#include "constraint/row.h"

/*
 * Pushes of pairs that slide somewhere become those of the smallest squares, as far as none becomes
 * negative; friction that slides goes with them. True: something has changed by more than `enough`,
 * m/s, and is to be swept again. What would take more than `most` multiplications is left as it is.
 */
bool rb_even(const struct rb_row_system *rows, double tolerance, double max,
             struct rb_arena *arena);

#endif
