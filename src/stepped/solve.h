/* SPDX-License-Identifier: MIT */
/*
 * Contact points of a step -> islands -> impulses.
 *
 * Islands of few rows are solved concurrently, one worker each; large ones one after the other, by
 * all workers. How an island is solved: stepped/strategies. Owned by the method's state; arrays are
 * kept from step to step.
 */
#ifndef RB_STEPPED_SOLVE_H
#define RB_STEPPED_SOLVE_H

#include "stepped/islands.h"

RB_CHECKED enum rb_status rb_solver_create(struct rb_solver *solver, const struct rb_model *model,
                                           struct rb_error *err);
void rb_solver_release(struct rb_solver *solver);

/* m/s: largest closing velocity of a gap that a solution of a step of h_s may leave. */
double rb_solver_tolerance(const struct rb_model *model, double h_s);

/*
 * Takes velocities after the step's forces from the world, those before them from `before`; solves;
 * stores impulses in the points. An island that is at rest under the same forces is not solved
 * again.
 */
RB_CHECKED enum rb_status rb_solver_step(struct rb_solver *solver, struct rb_world *world,
                                         const struct rb_state *before,
                                         struct rb_step_points *points, double h_s,
                                         struct rb_error *err);

/*
 * Repeats the step with other points for islands whose bodies are marked in `again`; the others
 * keep their solution. The world's velocities are those without impulses again.
 */
RB_CHECKED enum rb_status rb_solver_again(struct rb_solver *solver, struct rb_world *world,
                                          struct rb_step_points *points, const unsigned char *again,
                                          struct rb_error *err);

/* Restores the beginning of the step, with the velocities after its forces. */
void rb_solver_go_back(const struct rb_solver *solver, struct rb_world *world);

/*
 * For an attempt that is not kept, or will be repeated: bodies that came to rest only in it have no
 * reference forces of their rest yet.
 */
void rb_solver_forget_rest(struct rb_solver *solver, const int *body, int count);

/*
 * After positions have moved: gives islands that take impulses in halves their second half
 * (second_half).
 */
RB_CHECKED enum rb_status rb_solver_end(struct rb_solver *solver, struct rb_world *world,
                                        struct rb_error *err);

/* Whether anything in the scene may rebound. */
bool rb_solver_rebounds(const struct rb_solver *solver);

/*
 * Rebound of the step's impacts: velocities only, after positions have moved. `rebound` [points]
 * receives the impulses on b, where there are any.
 */
RB_CHECKED enum rb_status rb_solver_rebound(struct rb_solver *solver, struct rb_world *world,
                                            const struct rb_step_points *points, rb_vec3 *rebound,
                                            struct rb_error *err);

#endif
