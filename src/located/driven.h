/* SPDX-License-Identifier: MIT */
/*
 * Bodies that a function of time drives, and what motors follow: polynomial pieces through what the
 * function says, from one piece's end to the next. Through velocities where it gives them, else
 * through poses, smoothly joined: what rests on a body must not be shaken off where two pieces
 * meet.
 */
#ifndef RB_LOCATED_DRIVEN_H
#define RB_LOCATED_DRIVEN_H

#include "located/arc.h"

/*
 * The next piece of a driven body from `t` on; its end goes into the queue by rb_predict. Sets
 * l->status.
 */
void rb_driven_piece(struct rb_located *l, int i, double t);
void rb_driven_release(struct rb_located *l);

/*
 * What is known of a driven body's function, and its piece (l->piece must be there when a body has
 * one).
 */
void rb_driven_pack(struct rb_located *l, int i, struct rb_pack *pack);

/*
 * The next piece, from `t` on, of what the motor of a joint follows: values and rates are those of
 * RB_PIECE_POSITION and RB_PIECE_VELOCITY. `own` is what is kept of it. NULL: l->status says why.
 */
const struct rb_gauss_piece *rb_driven_motor(struct rb_located *l, int joint, double t,
                                             struct rb_driven **own);
void rb_driven_free(struct rb_driven *own);
/* The piece, NULL: there is none. */
const struct rb_gauss_piece *rb_driven_pack_motor(struct rb_driven **own, struct rb_pack *pack);

#endif
