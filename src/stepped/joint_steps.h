/* SPDX-License-Identifier: MIT */
/*
 * Joints from step to step: what a try begins with, how far they have drifted at its end, and what
 * of it is kept.
 *
 * A try is looked at again (stepped/relinearize) for groups with a joint that has drifted by more
 * than a share of the tolerance: what its rows miss is added to their bends. Where that does not
 * help, the step is halved for the bodies concerned.
 *
 * Owned by the method's state (rb_solver's `joint`); simulator thread. Without joints all of it
 * returns at once.
 */
#ifndef RB_STEPPED_JOINT_STEPS_H
#define RB_STEPPED_JOINT_STEPS_H

#include "stepped/stepped_state.h"

/* When the state is made, or another method has had the world: free coordinates as they stand. */
void rb_joints_start(struct rb_world *world);

/* A whole step begins: what can be gone back to, and sums for mean forces. */
void rb_joints_begin(struct rb_world *world);
/* These bodies go back to it. */
void rb_joints_go_back(struct rb_world *world, const struct rb_cohort *cohort);

/* A try of h_s begins: bends as foreseen; where motors that follow are to be at its end. */
RB_CHECKED enum rb_status rb_joints_try(struct rb_world *world, const struct rb_cohort *cohort,
                                        double start_s, double h_s, struct rb_error *err);

/*
 * m: the largest error of the joint as bodies stand, beyond what is to be `left` of each row (NULL:
 * nothing). Into `miss` go all errors.
 */
double rb_joints_miss(const struct rb_world *world, int k, struct rb_step_joint *of,
                      const double *left);
/* Where bodies stand at the end of a try: marks groups of which a joint has drifted; any. */
bool rb_joints_mark(struct rb_world *world, unsigned char *of_group);
/* What the rows of marked groups have missed is added to their bends. */
void rb_joints_bend(struct rb_world *world, const unsigned char *of_group);

/* Blames bodies of joints that have drifted by more than the tolerance. */
void rb_joints_blame(struct rb_world *world, const struct rb_cohort *cohort,
                     struct rb_attempt_outcome *outcome);

/*
 * Blames mechanisms whose joints have done work by what holds them: the step does not resolve how
 * they move.
 */
RB_CHECKED enum rb_status rb_joints_blame_held(struct rb_world *world, double h,
                                               struct rb_error *err);

/* A step of h_s is kept, but for bodies with a mark in `skip` (or NULL). */
void rb_joints_keep(struct rb_world *world, const struct rb_cohort *cohort, double h_s,
                    const unsigned char *skip);

/* m, rad: the free coordinate as bodies stand, h_s after the joint's was kept; 0: it has none. */
double rb_joints_way(const struct rb_world *world, int joint, double h_s);

/* Where it stands, and how it moves; -1: the world. */
struct rb_pose rb_joints_pose(const struct rb_world *world, int body);

/* N, N m about b's point: what the joint has exerted on b, the mean of the whole step. */
void rb_joints_load(const struct rb_stepped *stepped, int joint, rb_vec3 *reaction, rb_vec3 *twist);

/*
 * The joint that holds after another at a body, of which this is the owner; -1: none. `*at` begins
 * with -1.
 */
int rb_joints_next_of(const struct rb_world *world, int body, int *at);

#endif
