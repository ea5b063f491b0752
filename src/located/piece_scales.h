/* SPDX-License-Identifier: MIT */
/* Scales of a cluster's values, to which the integrator's errors are relative. */
#ifndef RB_LOCATED_PIECE_SCALES_H
#define RB_LOCATED_PIECE_SCALES_H

#include "located/modes.h"

/*
 * Fills `scale`, a size > 0 for each value of the piece, from the forces at its beginning; returns
 * the default step length, s.
 */
double rb_piece_scales_of(struct rb_modes *w, double *scale);

/* Largest of the accelerations whose differences are those of the members, m/s^2. */
double rb_piece_scales_load(const struct rb_modes *w);

/* Shortest time in which that load would move a member by its size, s; HUGE_VAL: none. */
double rb_piece_scales_fall(const struct rb_modes *w);

#endif
