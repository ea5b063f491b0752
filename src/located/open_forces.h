/* SPDX-License-Identifier: MIT */
/*
 * Forces of which contacts leave some open, because there are more of them than freedoms: all that
 * do the same to the bodies, and which of these are within the law.
 *
 * Everything is in the arena; simulator's thread.
 */
#ifndef RB_LOCATED_OPEN_FORCES_H
#define RB_LOCATED_OPEN_FORCES_H

#include "base/arena.h"
#include "math/dense.h"
#include "math/vec3.h"

/* A contact among the unknowns of a system. */
struct rb_open_contact {
	int row;         /* its first unknown */
	bool slips;      /* one unknown, the normal force with its friction; else three: axes */
	double friction; /* while it sticks */
	rb_vec3 normal;
	rb_vec3 unit;         /* force per unit of the unknown, while it slips */
	int a, b;             /* bodies, < 0: one that forces do not move */
	rb_vec3 arm_a, arm_b; /* m */
};

struct rb_open_forces {
	struct rb_arena *arena;
	struct rb_dense *dense;          /* solved; its right side is used up */
	struct rb_open_contact *contact; /* [contacts]; others have unknowns that are left alone */
	int contacts, bodies;
};

/*
 * Of all that act the same on the bodies, `least` [n] becomes the one of least squares and `change`
 * [n] the smallest change. Neither depends on the order of contacts. False: no memory.
 */
bool rb_open_forces_close(struct rb_open_forces *open, double *least, double *change);

/*
 * Brings unknowns [n] into all cones, if forces that move no body otherwise can do so; else they
 * stay. False: no memory.
 */
bool rb_open_forces_keep_law(struct rb_open_forces *open, double *unknown);

#endif
