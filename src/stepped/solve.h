/* SPDX-License-Identifier: MIT */
/*
 * Points of a step -> groups of bodies that they join -> impulses.
 *
 * Groups of few rows are solved at the same time, one worker each; large ones one after the other, by all. Sweeps first;
 * where these do not come to an end soon, factors, if the group's are not too large; else more sweeps.
 * Owned by the method's state; arrays are kept from step to step.
 */
#ifndef RB_STEPPED_SOLVE_H
#define RB_STEPPED_SOLVE_H

#include "stepped/row.h"
#include "stepped/touch.h"

struct rb_island {
	int first_row, row_count;
	int first_member, member_count;
	bool rebounds;
	double energy; /* J, twice: what a rebound may come to, but for work of driven bodies in it */
	double share;        /* of the rebound, that keeps to it */
	int sweeps, factors; /* of the last solution */
	double residual;     /* m/s */
};

struct rb_solver {
	int body_count;
	const int *
		active; /* borrowed: bodies of the step, those that yield ascending, then driven ones */
	int active_count;
	struct rb_dense
		dense;   /* owned: body [bodies + 1], the last one for all that stands still */
	rb_mat3 *tensor; /* owned; NULL: no body needs one */
	struct rb_dense_body *free;               /* owned */
	int *parent, *island_of, *member, *local; /* owned, [bodies + 1] */
	double *reach;                            /* owned, m: as of the model */
	unsigned char *pushed; /* owned: a point of the last step's has an impulse on it */
	unsigned char *rests;  /* owned: 1 where the body stands still */
	double *rest_pull; /* owned, [6 bodies] m/s^2, rad/s^2: forces of the step that found it so */
	struct rb_island *island; /* owned */
	size_t island_count, island_capacity, row_capacity;
	const struct rb_state
		*before;    /* borrowed: at the beginning of the step; NULL: positions are closed */
	double h_s, enough; /* of the step; m/s */
	bool hands_over; /* the last step before locating goes on: what touches is left without approach */
};

RB_CHECKED enum rb_status rb_solver_create(struct rb_solver *solver, const struct rb_model *model,
                                           struct rb_error *err);
void rb_solver_release(struct rb_solver *solver);

/*
 * Takes velocities with the step's forces from the world, those before it from `before`; solves; impulses go to the points.
 * A group that stood still under the same forces is not solved again.
 */
RB_CHECKED enum rb_status rb_solver_step(struct rb_solver *solver, struct rb_world *world,
                                         const struct rb_state *before, struct rb_points *points,
                                         double h_s, struct rb_error *err);

/*
 * Impacts of that step rebound: velocities only, after positions have moved. `rebound` [points] receives the impulses on b,
 * where there are any.
 */
RB_CHECKED enum rb_status rb_solver_rebound(struct rb_solver *solver, struct rb_world *world,
                                            const struct rb_points *points, rb_vec3 *rebound,
                                            struct rb_error *err);

#endif
