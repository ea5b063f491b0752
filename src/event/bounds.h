/* SPDX-License-Identifier: MIT */
/* How fast a body can get to move and turn, from a moment to the end of its arc. */
#ifndef RB_EVENT_BOUNDS_H
#define RB_EVENT_BOUNDS_H

#include "event/arc.h"

struct rb_bounds {
	double turn, turning; /* rad/s, rad/s^2 */
	double pull, jerk;    /* m/s^2, m/s^3: of the centre of its shape */
	double own_pull;      /* m/s^2: of the centre of mass */
};
struct rb_bounds rb_bounds_of(const struct rb_located *l, int i);

#endif
