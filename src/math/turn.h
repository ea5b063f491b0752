/* SPDX-License-Identifier: MIT */
/*
 * Where a body has turned to whose spin over a piece of math/gauss is known: the orientation
 * follows from it and nothing follows from the orientation. Any thread.
 */
#ifndef RB_MATH_TURN_H
#define RB_MATH_TURN_H

#include "math/gauss.h"
#include "math/quat.h"

/*
 * After `t` seconds of the piece, 0 <= t <= length_s, to rounding; `orientation` is that at its
 * beginning, `spin` the first of three of its values (rad/s, world axes).
 */
rb_quat rb_turn_through(const struct rb_gauss_piece *piece, int spin, rb_quat orientation,
                        double t);

#endif
