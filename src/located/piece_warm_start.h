/* SPDX-License-Identifier: MIT */
/*
 * What a body leaves with the piece that it goes from, for the one that it goes to at the same
 * moment: what rounding has left of its place and velocities, as long as these are the same, and
 * how its rates were, which is where the integrator begins to look for those to come. Holds within
 * one event: no checkpoint has it.
 */
#ifndef RB_LOCATED_PIECE_WARM_START_H
#define RB_LOCATED_PIECE_WARM_START_H

#include "located/located.h"

enum { RB_PIECE_WARM_START_ROWS = 13 };

struct rb_piece_warm_start {
	uint64_t moment;                   /* l->moment; 0: nothing */
	double origin_s, length_s, left_s; /* of the piece; when it was left */
	rb_vec3 position, left_out;        /* as of the pose then, which they belong to */
	double value[RB_PIECE_WARM_START_ROWS],
		rest[RB_PIECE_WARM_START_ROWS]; /* of the piece then */
	double coefficient[RB_GAUSS_NODES][RB_PIECE_WARM_START_ROWS];
};

/* Room for what bodies on pieces have, l->piece and this; false: no memory. */
bool rb_piece_warm_start_reserve(struct rb_located *l);

/* The body leaves its piece, if it is on one and has not left it at this moment already. */
void rb_piece_warm_start_keep(const struct rb_located *l, int i, double t);

/* What it has left at this moment; NULL: nothing. */
const struct rb_piece_warm_start *rb_piece_warm_start_at(const struct rb_located *l, int i,
                                                         double t);

#endif
