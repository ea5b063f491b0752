/* SPDX-License-Identifier: MIT */
/*
 * Pairs that could touch, from boxes fat enough for several steps.
 *
 * Owned by the method's state. The candidates hold until a body could leave its box; their boxes decide cost only, but for
 * the order in which ties are met, which is by pair.
 */
#ifndef RB_STEPPED_NEAR_H
#define RB_STEPPED_NEAR_H

#include "step/broadphase.h"
#include "world/world.h"

struct rb_near {
	bool valid;
	rb_vec3 *built_at; /* [bodies] m: the objects' origins when the boxes were made */
	double *margin;    /* [bodies] m: how far each may get from there */
	double *reach; /* [bodies] m: how far each gets in the step under way, if nothing touches it */
	rb_aabb *box;
	double h_s;                 /* of that step */
	const struct rb_pair *pair; /* borrowed from the broadphase */
	size_t pair_count;
	/*
	 * [pair_count] of each pair a direction that has told it apart, or zero. Whoever looks at a pair may write it: it
	 * decides cost only.
	 */
	rb_vec3 *axis;
	size_t axis_capacity;
};

RB_CHECKED enum rb_status rb_near_create(struct rb_near *near, const struct rb_model *model,
                                         struct rb_error *err);
void rb_near_release(struct rb_near *near);

/* The world's velocities have the forces of the step, of length h_s, in them; those before stand in `before`. */
RB_CHECKED enum rb_status rb_near_find(struct rb_near *near, struct rb_world *world,
                                       const struct rb_state *before, double h_s,
                                       struct rb_error *err);

/* Whether every body is still within its margin; NaN is not. */
bool rb_near_holds(const struct rb_near *near, const struct rb_world *world);

#endif
