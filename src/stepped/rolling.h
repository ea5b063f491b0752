/* SPDX-License-Identifier: MIT */
/*
 * Rims and balls that roll. The lowest point of a rim goes round it, and the gap there follows the
 * outline of the turned rim: by the end of a step it differs in the second order from where the
 * step's first lowest point has gone along its tangent. So it does at a ball whose middle is not
 * the centre of mass: a lopsided one, the end of a capsule. Without that each step leaves an
 * approach that the next one stops, and the loss is of the first order: with it, velocities stand
 * for the middle of a step and impulses between two of them, and it is of the second.
 */
#ifndef RB_STEPPED_ROLLING_H
#define RB_STEPPED_ROLLING_H

#include "geom/patch.h"
#include "world/world.h"

/* 0, 1: the end of a cylinder whose rim that is; -1: none. */
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
 * m: more of a gap by the end of a step of h than straight ways make it, of a ball on something
 * flat: `middle` is its own, from the centre of mass of body i, `outward` the way to the flat.
 */
double rb_rolling_bend_of_ball(const struct rb_world *world, int i, rb_vec3 middle, rb_vec3 outward,
                               double h);

/* The same, where one of the parts may roll. */
double rb_rolling_bend_of_round(const struct rb_world *world, const struct rb_rolling *rolling);

/* Whether it has rims, or corners with balls round them. */
static inline bool rb_rolling_may(const rb_core *core)
{
	return core->kind == RB_CORE_CYLINDER || core->radius > 0;
}

/*
 * m: more of a gap by the end of a step than straight ways make it; 0 unless it is the lowest point
 * of a rim or a ball on something flat.
 */
static inline double rb_rolling_bend(const struct rb_world *world, const struct rb_rolling *rolling)
{
	return rb_rolling_may(rolling->part[0]->core) || rb_rolling_may(rolling->part[1]->core)
	               ? rb_rolling_bend_of_round(world, rolling)
	               : 0;
}

#endif
