/* SPDX-License-Identifier: MIT */
/*
 * Contact forces that are not determined, because there are more contacts than degrees of freedom:
 * the set of forces with the same effect on the bodies, and those of them that satisfy the law.
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
	int row;    /* its first unknown */
	bool slips; /* one unknown, the normal force with its friction; otherwise three, by axes */
	double friction; /* while it sticks */
	rb_vec3 normal;
	rb_vec3 unit;         /* force per unit of the unknown, while it slips */
	int a, b;             /* bodies, < 0: not dynamic */
	rb_vec3 arm_a, arm_b; /* m */
};

struct rb_open_forces {
	struct rb_arena *arena;
	struct rb_dense *dense; /* solved; its right side is overwritten */
	struct rb_open_contact
		*contact; /* [contacts]; unknowns of other contacts are not changed */
	int contacts, bodies;
};

/*
 * Makes unknowns [n] those of least squares among all that satisfy the modes, which does not depend
 * on the order of contacts. Those before `first` count only where the others leave a choice. False:
 * out of memory.
 */
bool rb_open_forces_close(struct rb_open_forces *open, size_t first, double *unknown);

/*
 * Brings unknowns [n] into all cones by forces without effect on the bodies, or, if `moves`, by any
 * that the modes leave open; leaves them if that is not possible. False: out of memory.
 */
bool rb_open_forces_keep_law(struct rb_open_forces *open, bool moves, double *unknown);

#endif
