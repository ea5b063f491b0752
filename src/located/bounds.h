/* SPDX-License-Identifier: MIT */
/* Bounds on a body's motion and rotation from a time to the end of its arc or piece. */
#ifndef RB_LOCATED_BOUNDS_H
#define RB_LOCATED_BOUNDS_H

#include "located/arc.h"

struct rb_bounds {
	double turn, turning; /* rad/s, rad/s^2 */
	double growing;       /* rad/s^2: rate at which the spin may grow; 0: `turn` bounds it */
	/*
	 * a body-fixed unit axis, object coordinates, and bounds of its direction's rates: small
	 * for a body that spins fast about it
	 */
	rb_vec3 axis;
	double axis_turn, axis_bend; /* 1/s, 1/s^2 */
	double external, jerk;       /* m/s^2, m/s^3: of the shape's centre */
	double own_external;         /* m/s^2: of the centre of mass */
};
struct rb_bounds rb_bounds_of(const struct rb_located *l, int i);

/*
 * Bound on a body's acceleration along a unit vector from t on, while it is on its arc or piece,
 * m/s^2. Below zero: it accelerates the other way throughout.
 */
double rb_bounds_along(const struct rb_located *l, int i, rb_vec3 n, double t);

#endif
