/* SPDX-License-Identifier: MIT */
/*
 * Functions of time that drive bodies, or that motors follow, as successive polynomial pieces.
 * Pieces interpolate velocities if the function gives them, else poses, with continuous velocity:
 * a body at rest on a driven one must not be thrown off where two pieces join. Simulator's thread.
 */
#ifndef RB_LOCATED_DRIVEN_H
#define RB_LOCATED_DRIVEN_H

#include "located/arc.h"

/*
 * Begins the next piece of a driven body at `t`; rb_predict puts its end into the queue. Sets
 * l->status.
 */
void rb_driven_piece(struct rb_located *l, int i, double t);
void rb_driven_release(struct rb_located *l);

/* Packs a driven body's function state and piece (l->piece must exist if the body has one). */
void rb_driven_pack(struct rb_located *l, int i, struct rb_pack *pack);

/*
 * The next piece, from `t` on, of the function that a joint's motor follows, with values in
 * RB_PIECE_POSITION and rates in RB_PIECE_VELOCITY. `own`: its state, created when NULL. NULL:
 * failed, see l->status.
 */
const struct rb_gauss_piece *rb_driven_motor(struct rb_located *l, int joint, double t,
                                             struct rb_driven **own);
void rb_driven_free(struct rb_driven *own);
/* Packs the state; returns its piece, NULL: none. */
const struct rb_gauss_piece *rb_driven_pack_motor(struct rb_driven **own, struct rb_pack *pack);

#endif
