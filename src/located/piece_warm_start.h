/* SPDX-License-Identifier: MIT */
/*
 * State carried from a body's old piece to its next one at the same time: rounding remainders of
 * position and velocities, valid while these are unchanged, and the old piece's coefficients, from
 * which the integrator extrapolates its initial guess. Valid within one event, so it is not saved
 * in checkpoints.
 */
#ifndef RB_LOCATED_PIECE_WARM_START_H
#define RB_LOCATED_PIECE_WARM_START_H

#include "located/located.h"

enum { RB_PIECE_WARM_START_ROWS = 13 };

struct rb_piece_warm_start {
	uint64_t moment;                   /* l->moment at which it was left; 0: never */
	double origin_s, length_s, left_s; /* of the piece; time at which it was left */
	rb_vec3 position, left_out; /* of the pose then: position and its rounding remainder */
	double value[RB_PIECE_WARM_START_ROWS],
		rest[RB_PIECE_WARM_START_ROWS]; /* rows of the piece then, and their remainders */
	double coefficient[RB_GAUSS_NODES][RB_PIECE_WARM_START_ROWS];
};

/* Reserves l->piece and l->warm_start; false: no memory. */
bool rb_piece_warm_start_reserve(struct rb_located *l);

/* Frees l->warm_start, between events; l->piece stays, for the remainders of positions. */
void rb_piece_warm_start_release(struct rb_located *l);

/* Keeps the state of a body's piece, unless it is on none or was kept at this moment already. */
void rb_piece_warm_start_keep(const struct rb_located *l, int i, double t);

/* The state kept at this moment; NULL: none. */
const struct rb_piece_warm_start *rb_piece_warm_start_at(const struct rb_located *l, int i,
                                                         double t);

#endif
