/* SPDX-License-Identifier: MIT */
/*
 * Rolling rims and eccentric balls. The lowest point of a rim moves round it, and the gap there
 * follows the outline of the rotated rim: at the end of a step it differs in second order from the
 * displacement of the initial lowest point along its tangent. The same holds for a ball whose
 * centre is not the centre of mass: an eccentric sphere, the end of a capsule. Without that term
 * each step leaves an approach that the next one stops, a loss of first order; with it, velocities
 * refer to the middle of a step and impulses to the time between two, and the loss is of second
 * order.
 */
#ifndef RB_STEPPED_ROLLING_H
#define RB_STEPPED_ROLLING_H

#include "geom/patch.h"
#include "world/world.h"

/* End of a cylinder whose rim that is, 0 or 1; -1: none. */
int rb_rolling_end(rb_part feature);

/* A point of two parts, a's first, at which they may touch. */
struct rb_rolling {
	const rb_placed *const *part;
	int body[2];
	rb_vec3 arm[2]; /* m, from the centres of mass */
	rb_vec3 normal; /* unit, from a to b */
	uint64_t key;   /* features: a's in the upper half, b's in the lower */
	double h_s;
};

/*
 * Nonlinear part of the gap at the end of a step of h, m, of a ball on a flat: `middle` is its
 * centre, from the centre of mass of body i, `outward` the direction to the flat.
 */
double rb_rolling_bend_of_ball(const struct rb_world *world, int i, rb_vec3 middle, rb_vec3 outward,
                               double h);

/* The same, where one of the parts may roll. */
double rb_rolling_bend_of_round(const struct rb_world *world, const struct rb_rolling *rolling);

/* Whether it has rims or rounded corners. */
static inline bool rb_rolling_may(const rb_core *core)
{
	return core->kind == RB_CORE_CYLINDER || core->radius > 0;
}

/*
 * Nonlinear part of the gap at the end of a step, m; 0 unless the point is the lowest one of a rim
 * or a ball on a flat.
 */
static inline double rb_rolling_bend(const struct rb_world *world, const struct rb_rolling *rolling)
{
	return rb_rolling_may(rolling->part[0]->core) || rb_rolling_may(rolling->part[1]->core)
	               ? rb_rolling_bend_of_round(world, rolling)
	               : 0;
}

#endif
