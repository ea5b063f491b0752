/* SPDX-License-Identifier: MIT */
/* How large the values of a cluster are, against which the integrator's errors are small or not. */
#ifndef RB_LOCATED_PIECE_SCALES_H
#define RB_LOCATED_PIECE_SCALES_H

#include "located/modes.h"

/*
 * Fills `scale`, a size > 0 for each value of the piece, after the forces at its beginning have
 * been found; returns the length to try without knowing better, s.
 */
double rb_piece_scales_of(struct rb_modes *w, double *scale);

/* m/s^2: the largest acceleration of which those of the members are differences, then. */
double rb_piece_scales_load(const struct rb_modes *w);

/* s: the shortest in which that load would move a member by its size; HUGE_VAL: there is none. */
double rb_piece_scales_fall(const struct rb_modes *w);

#endif
