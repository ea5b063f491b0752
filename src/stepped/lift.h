/* SPDX-License-Identifier: MIT */
/*
 * What closing overlaps by moving positions raises, and what pays for it: what contacts of the group have taken in the step,
 * then motion along the ways that closing has gone.
 *
 * Made for one step in its arena; simulator thread.
 */
#ifndef RB_STEPPED_LIFT_H
#define RB_STEPPED_LIFT_H

#include "stepped/inside.h"

struct rb_lift {
	int *parent;  /* [bodies]: groups: of the solution, joined by those that are closed */
	double *room; /* [bodies], J, twice: what contacts took, by the first of a group */
	double *way;  /* [6 bodies]: m; kg m^2 rad, as momentum */
	unsigned char *moved; /* [bodies] */
	unsigned char *given; /* [bodies]: a driven body has pushed, by a body of the group */
	unsigned char *held;  /* [bodies]: so has a static one */
	double *sum;          /* [4 bodies], J, by the first of a group */
};

/* Before the solver has become that of closing. */
RB_CHECKED enum rb_status rb_lift_begin(struct rb_lift *lift, struct rb_world *world,
                                        struct rb_error *err);

/* These bodies are closed together; b may be driven or static. */
void rb_lift_join(struct rb_lift *lift, const struct rb_world *world, int a, int b);

/* A body moves by what the solver has for it; its spin, put aside, turns with it. */
void rb_lift_add(struct rb_lift *lift, struct rb_world *world, int i);

/*
 * Velocities, given back, pay; groups that cannot are blamed: in shorter steps turning leaves less to close, with its square.
 */
void rb_lift_pay(struct rb_lift *lift, struct rb_world *world);

#endif
