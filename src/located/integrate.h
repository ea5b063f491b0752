/* SPDX-License-Identifier: MIT */
/*
 * Motion without a closed form: a cluster's bodies through one piece of the high-order integrator
 * (math/gauss), its contacts held in the modes that they have at its beginning; the piece is cut at
 * the first change of a mode.
 */
#ifndef RB_LOCATED_INTEGRATE_H
#define RB_LOCATED_INTEGRATE_H

#include "located/event_set.h"

/*
 * From the members' present arcs at `t`; puts them on the piece. `goes_on`: they come from the end
 * of a piece that nothing has cut. Sets l->status.
 */
void rb_integrate_piece(struct rb_located *l, int cluster, double t, bool goes_on);

/*
 * Forces of a cluster's contacts, N on b, at a moment of its piece; [held_count]. False: they are
 * not to be had. Changes nothing.
 */
bool rb_integrate_forces(struct rb_located *l, int cluster, double t, rb_vec3 *force);

/*
 * Values that a cluster's block holds while it is integrated, for n rows, and those of its piece,
 * which stand first. Arcs point into it, so it must not grow between one piece and the next.
 */
size_t rb_integrate_scratch_size(int n);
size_t rb_integrate_kept_size(int n);
/* The piece's arrays, in the block; its length is as it was. */
void rb_integrate_lay_out(struct rb_cluster *c, int n);

#endif
