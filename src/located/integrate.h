/* SPDX-License-Identifier: MIT */
/*
 * Motion without a closed form: integrates a cluster's bodies over one piece of the high-order
 * integrator (math/gauss), with its contacts in the modes that they have at its beginning; the
 * piece is cut at the first change of a mode.
 */
#ifndef RB_LOCATED_INTEGRATE_H
#define RB_LOCATED_INTEGRATE_H

#include "located/event_set.h"

/*
 * Integrates from the members' present arcs at `t`, and puts them on the piece. `goes_on`: it
 * continues a piece that was not cut. Sets l->status.
 */
void rb_integrate_piece(struct rb_located *l, int cluster, double t, bool goes_on);

/*
 * Computes the forces of a cluster's contacts at a moment of its piece, N on b, [held_count].
 * False: not available. Changes nothing.
 */
bool rb_integrate_forces(struct rb_located *l, int cluster, double t, rb_vec3 *force);

/*
 * Number of values in a cluster's block during integration of n rows, and in its piece, which comes
 * first. Arcs point into the block, so it must not grow between pieces.
 */
size_t rb_integrate_scratch_size(int n);
size_t rb_integrate_kept_size(int n);
/* Sets the piece's arrays within the block; its length is unchanged. */
void rb_integrate_lay_out(struct rb_cluster *c, int n);

#endif
