/* SPDX-License-Identifier: MIT */
/*
 * Joints from step to step: warm start of an attempt, drift at its end, and what is kept of it.
 *
 * An attempt is relinearized (stepped/relinearize) for groups with a joint whose drift exceeds a
 * share of the tolerance: the error of its rows is added to their nonlinear parts (`bend`). Where
 * that does not help, the step is halved for the bodies concerned.
 *
 * Owned by the method's state (rb_solver's `joint`); simulator thread. Without joints all of it
 * returns at once.
 */
#ifndef RB_STEPPED_JOINT_STEPS_H
#define RB_STEPPED_JOINT_STEPS_H

#include "stepped/stepped_state.h"

/* Initializes the free coordinates, when the state is created or after another method. */
void rb_joints_start(struct rb_world *world);

/*
 * At the beginning of a whole step: saves what rollback restores, and clears sums for mean forces.
 */
void rb_joints_begin(struct rb_world *world);
/* Restores joints of these bodies to it. */
void rb_joints_go_back(struct rb_world *world, const struct rb_cohort *cohort);

/*
 * At the beginning of an attempt of h_s: predicts nonlinear parts of rows, and sets the target of
 * motors that follow a function, for its end.
 */
RB_CHECKED enum rb_status rb_joints_begin_attempt(struct rb_world *world,
                                                  const struct rb_cohort *cohort, double start_s,
                                                  double h_s, struct rb_error *err);

/*
 * Largest error of a joint at the present poses, m, beyond the targets `left` of its rows (NULL:
 * zero). `miss` gets all errors.
 */
double rb_joints_error(const struct rb_world *world, int k, struct rb_step_joint *of,
                       const double *left);
/* At the end of an attempt: marks groups with a drifted joint; returns whether there are any. */
bool rb_joints_mark(struct rb_world *world, unsigned char *of_group);
/* Adds the errors of the rows of marked groups to their nonlinear parts. */
void rb_joints_bend(struct rb_world *world, const unsigned char *of_group);

/*
 * Blames bodies of joints that have drifted by more than the tolerance, or where that is not
 * promised by more than their size.
 */
void rb_joints_blame(struct rb_world *world, const struct rb_cohort *cohort,
                     struct rb_attempt_outcome *outcome);

/*
 * Blames mechanisms whose joints' constraint forces have done work: the step does not resolve their
 * motion.
 */
RB_CHECKED enum rb_status rb_joints_blame_held(struct rb_world *world, double h,
                                               struct rb_error *err);

/* Keeps a step of h_s, except for bodies with a mark in `skip` (or NULL). */
void rb_joints_keep(struct rb_world *world, const struct rb_cohort *cohort, double h_s,
                    const unsigned char *skip);

/*
 * Free coordinate at the present poses, m or rad, h_s after the joint's was kept; 0: it has none.
 */
double rb_joints_coordinate(const struct rb_world *world, int joint, double h_s);

/* Pose and motion of a body; -1: the world. */
struct rb_pose rb_joints_pose(const struct rb_world *world, int body);

/* Mean force and torque of the joint on b over the whole step, N, N m about b's point. */
void rb_joints_load(const struct rb_stepped *stepped, int joint, rb_vec3 *reaction, rb_vec3 *twist);

/* Next joint in effect whose rows this body owns; -1: none. `*at` begins with -1. */
int rb_joints_next_of(const struct rb_world *world, int body, int *at);

#endif
