/* SPDX-License-Identifier: MIT */
/*
 * The way of a tree of joints through a step, by what its joints leave free.
 *
 *     coordinates   of each joint what it leaves free, from where bodies stand as the step begins;
 *                   of balls, and of what hangs on nothing, orientation and spin
 *     rates         step/joint_tree
 *     step          Gauss-Legendre collocation with three nodes: order 6, symplectic, reversible
 *
 * Joints cannot drift: bodies are placed from the roots on. What errors joints begin with stay;
 * velocities that they do not let be are taken away, by the impulses that take the least energy.
 * Nodes are found by iteration to rounding.
 *
 * Arrays are the caller's (stepped/reduced_islands), who fills `world`, `before`, `tree`, `force`
 * and `drag`.
 */
#ifndef RB_STEPPED_REDUCED_STEP_H
#define RB_STEPPED_REDUCED_STEP_H

#include "force/drag.h"
#include "step/joint_tree.h"

enum { RB_REDUCED_STEP_NODES = 3 };

/* What of a link's motion is free, in one part of the step. */
struct rb_reduced_link {
	int ways;        /* free ways and angles of its joint */
	bool turns;      /* its orientation is free */
	bool floats;     /* so is its place: it hangs on nothing */
	double speed[2]; /* of ways and angles as the part begins */
	rb_quat turn;    /* then, from the body that it hangs on */
	rb_vec3 point; /* then, of the joint: in the axes of that body, m from its centre of mass */
	struct rb_pose begin;
	/* ways and angles; or the spin, and the velocity of the centre of mass */
	double first[6], rate[RB_REDUCED_STEP_NODES][6]; /* as the part begins, and at the nodes */
	rb_vec3 spin[RB_REDUCED_STEP_NODES];
	rb_quat orientation[RB_REDUCED_STEP_NODES];
};

struct rb_reduced_step {
	const struct rb_world *world;
	const struct rb_state *before;
	double h_s; /* of a part */
	struct rb_joint_tree tree;
	struct rb_reduced_link *course;                  /* [count] by link */
	struct rb_pose *pose[RB_REDUCED_STEP_NODES + 1]; /* [count] by place */
	rb_vec3 *linear[RB_REDUCED_STEP_NODES + 1];      /* [count] by place: accelerations */
	rb_vec3 *angular[RB_REDUCED_STEP_NODES + 1];
	struct rb_wrench *force; /* [count] m/s^2; N m: by all but joints and drag */
	struct rb_drag_def drag;
	struct rb_wrench *on;  /* [count] by link: what its joint exerts on it */
	struct rb_wrench *sum; /* [count] the same over the step */
	/* [count] by place, over the step: N s, N m s about the origin; J, what it has taken */
	struct rb_wrench *dragged;
	double *lost;
	rb_vec3 *place, *spin; /* [count] by place: integrals over the step */
	rb_vec3 *kept;         /* [2 count] scratch */
	uint64_t evaluations;
	double taken; /* J: with velocities that joints do not let be, as the step begins */
};

/*
 * Takes the step of h_s in as few equal parts as converge, by powers of two: bodies end at
 * pose[RB_REDUCED_STEP_NODES], sums are filled. False: these are too many.
 */
bool rb_reduced_step_take(struct rb_reduced_step *s, double h_s);

/* As the step begins: m/s, m/s^2, the largest of what moves and of what it is accelerated by. */
double rb_reduced_step_speed(struct rb_reduced_step *s);
double rb_reduced_step_acceleration(struct rb_reduced_step *s);

/* I v of a body in world axes: kg m^2/s for a spin. */
rb_vec3 rb_reduced_step_weigh(const struct rb_model *model, int i, rb_quat q, rb_vec3 v);

#endif
