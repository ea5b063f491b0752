/* SPDX-License-Identifier: MIT */
/*
 * Points of a step -> groups of bodies that they join -> impulses.
 *
 * Groups of few rows are solved at the same time, one worker each; large ones one after the other,
 * by all. Sweeps first; where these do not come to an end soon, factors, if the group's are not too
 * large; else more sweeps. Owned by the method's state; arrays are kept from step to step.
 */
#ifndef RB_STEPPED_SOLVE_H
#define RB_STEPPED_SOLVE_H

#include "stepped/islands.h"

RB_CHECKED enum rb_status rb_solver_create(struct rb_solver *solver, const struct rb_model *model,
                                           struct rb_error *err);
void rb_solver_release(struct rb_solver *solver);

/* m/s: what a solution of a step of h_s may leave of the closing of gaps. */
double rb_solver_tolerance(const struct rb_model *model, double h_s);

/*
 * Takes velocities with the step's forces from the world, those before it from `before`; solves;
 * impulses go to the points. A group that stood still under the same forces is not solved again.
 */
RB_CHECKED enum rb_status rb_solver_step(struct rb_solver *solver, struct rb_world *world,
                                         const struct rb_state *before,
                                         struct rb_step_points *points, double h_s,
                                         struct rb_error *err);

/*
 * The same step with other points for groups whose bodies have a mark in `again`; the others keep
 * what was found. The world's velocities are those without impulses again.
 */
RB_CHECKED enum rb_status rb_solver_again(struct rb_solver *solver, struct rb_world *world,
                                          struct rb_step_points *points, const unsigned char *again,
                                          struct rb_error *err);

/* The beginning of the step, with the velocities that its forces have made. */
void rb_solver_go_back(const struct rb_solver *solver, struct rb_world *world);

/*
 * Of a try that is not kept, or will be looked at again: who stands still only since then has no
 * forces yet that it stands still with.
 */
void rb_solver_forget_rest(struct rb_solver *solver, const int *body, int count);

/* Positions have moved: groups that take impulses in halves get the second one (second_half). */
RB_CHECKED enum rb_status rb_solver_end(struct rb_solver *solver, struct rb_world *world,
                                        struct rb_error *err);

/* Whether something may rebound: a scene without restitution has no such impulses. */
bool rb_solver_rebounds(const struct rb_solver *solver);

/*
 * Impacts of that step rebound: velocities only, after positions have moved. `rebound` [points]
 * receives the impulses on b, where there are any.
 */
RB_CHECKED enum rb_status rb_solver_rebound(struct rb_solver *solver, struct rb_world *world,
                                            const struct rb_step_points *points, rb_vec3 *rebound,
                                            struct rb_error *err);

#endif
