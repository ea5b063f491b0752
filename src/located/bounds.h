/* SPDX-License-Identifier: MIT */
/* How fast a body can get to move and turn, from a moment to the end of its arc. */
#ifndef RB_LOCATED_BOUNDS_H
#define RB_LOCATED_BOUNDS_H

#include "located/arc.h"

struct rb_bounds {
	double turn, turning; /* rad/s, rad/s^2 */
	double growing;       /* rad/s^2: by which the spin grows; else `turn` bounds it for good */
	/*
	 * of an axis of the body, object coordinates, unit, its direction's rates: of what spins
	 * fast about it, slow ones
	 */
	rb_vec3 axis;
	double axis_turn, axis_bend; /* 1/s, 1/s^2 */
	double external, jerk;       /* m/s^2, m/s^3: of the centre of its shape */
	double own_external;         /* m/s^2: of the centre of mass */
};
struct rb_bounds rb_bounds_of(const struct rb_located *l, int i);

/*
 * m/s^2: bound from t on, while it is on its arc or piece, on a body's acceleration along a unit
 * vector. Below zero: it is surely the other way.
 */
double rb_bounds_along(const struct rb_located *l, int i, rb_vec3 n, double t);

#endif
