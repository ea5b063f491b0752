/* SPDX-License-Identifier: MIT */
/*
 * Pairs that could touch, from boxes fat enough for several steps.
 *
 * Owned by the method's state. The candidates hold until a body could leave its box; their boxes decide cost only, but for
 * the order in which ties are met, which is by pair.
 */
#ifndef RB_STEPPED_NEAR_H
#define RB_STEPPED_NEAR_H

#include "geom/core.h"
#include "step/broadphase.h"
#include "world/world.h"

/* What is known of a pair from the look before; decides cost only. */
struct rb_clue {
	rb_vec3 axis;  /* the direction in which it was told apart, or touches; zero: none */
	bool is_close; /* it was not told apart */
};

struct rb_near {
	bool valid;
	rb_vec3 *built_at; /* [bodies] m: the objects' origins when the boxes were made */
	double *margin;    /* [bodies] m: how far each may get from there */
	double *reach; /* [bodies] m: how far each gets in the step under way, if nothing touches it */
	rb_aabb *box;
	double h_s;                 /* of that step */
	const struct rb_pair *pair; /* borrowed from the broadphase */
	size_t pair_count;
	/* Of scenes with parts: what geometry is asked about. Whoever looks at a pair may write its clue. */
	struct rb_clue *clue; /* [pair_count] */
	size_t clue_capacity;
	int *first_part;   /* [bodies and statics + 1] into `placed` */
	rb_placed *placed; /* where parts stand: rb_near_place */
	double *ahead;     /* [bodies] m: how far points of each may get in the step, turning too */
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

/* Parts as bodies stand now, and what their turning may add. */
void rb_near_place(struct rb_near *near, struct rb_world *world);

#endif
