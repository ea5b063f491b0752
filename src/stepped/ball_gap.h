/* SPDX-License-Identifier: MIT */
/* Gaps of spheres in closed form, as of the step: to spheres, planes and finite planes. */
#ifndef RB_STEPPED_BALL_GAP_H
#define RB_STEPPED_BALL_GAP_H

#include "step/broadphase.h"
#include "step/gap.h"

/*
 * Gap of a sphere to another shape. One that moves far is measured where its path at present
 * velocities touches or comes closest: the tangent plane at the nearest point of the start would
 * stop it where it only passes.
 */
struct rb_gap rb_ball_gap_ahead(const struct rb_world *world, struct rb_pair pair, double h_s);

/*
 * Whether a sphere comes to the border of a finite plane from the side, as in
 * stepped/internal_edges: the plane separates them as long as forces do not move it through the
 * plane. `held`: contacts had forces on both in the last step.
 */
bool rb_ball_gap_is_beside(const struct rb_world *world, struct rb_pair pair, double h_s,
                           bool held);

#endif
