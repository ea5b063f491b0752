/* SPDX-License-Identifier: MIT */
/*
 * Motion of a tree of joints through a step in reduced coordinates.
 *
 *     coordinates   the degrees of freedom of each joint, relative to the poses at the beginning of
 *                   the step; orientation and spin of balls and of links without a parent
 *     rates         step/joint_tree
 *     step          Gauss-Legendre collocation with three nodes: order 6, symplectic, reversible
 *
 * Joints cannot drift: bodies are placed from the roots on. Position errors that joints begin with
 * stay; velocities that violate joints are removed, by the impulses that dissipate the least
 * energy. Nodes are found by fixed-point iteration to rounding.
 *
 * Arrays are the caller's (stepped/reduced_islands), who fills `world`, `before`, `tree`, `force`
 * and `drag`.
 */
#ifndef RB_STEPPED_REDUCED_STEP_H
#define RB_STEPPED_REDUCED_STEP_H

#include "force/drag.h"
#include "step/joint_tree.h"

enum { RB_REDUCED_STEP_NODES = 3 };

/* Degrees of freedom of a link, in one part of the step. */
struct rb_reduced_link {
	int coordinate_count; /* free displacements and angles of its joint */
	bool turns;           /* its orientation is free (quaternion) */
	bool floats;          /* so is its position: it has no parent */
	double speed[2];      /* of displacements and angles as the part begins */
	rb_quat turn;         /* orientation then, relative to its parent */
	/* point of the joint then: in the parent's axes, m from its centre of mass */
	rb_vec3 point;
	struct rb_pose begin;
	/*
	 * second rates of displacements and angles; or of the spin, and of the velocity of the
	 * centre of mass
	 */
	double first[6], rate[RB_REDUCED_STEP_NODES][6]; /* as the part begins, and at the nodes */
	rb_vec3 spin[RB_REDUCED_STEP_NODES];
	rb_quat orientation[RB_REDUCED_STEP_NODES];
};

struct rb_reduced_step {
	const struct rb_world *world;
	const struct rb_state *before;
	double h_s; /* of a part */
	struct rb_joint_tree tree;
	struct rb_reduced_link *path;                    /* [count] by link */
	struct rb_pose *pose[RB_REDUCED_STEP_NODES + 1]; /* [count] by place in `tree` */
	rb_vec3 *linear[RB_REDUCED_STEP_NODES + 1];      /* [count] by place: accelerations */
	rb_vec3 *angular[RB_REDUCED_STEP_NODES + 1];
	struct rb_wrench *force; /* [count] m/s^2; N m: of all but joints and drag */
	struct rb_drag_def drag;
	struct rb_wrench *on;  /* [count] by link: load of its joint on it */
	struct rb_wrench *sum; /* [count] integral of it over the step */
	/*
	 * [count] by place, over the step, of drag: N s, N m s about the origin; J, energy
	 * dissipated
	 */
	struct rb_wrench *dragged;
	double *lost;
	rb_vec3 *place, *spin; /* [count] by place: integrals over the step */
	rb_vec3 *kept;         /* [2 count] scratch */
	uint64_t evaluations;
	/* J: energy of the velocities violating joints that were removed as the step began */
	double taken;
};

/*
 * Takes the step of h_s in as few equal parts as converge, a power of two: bodies end at
 * pose[RB_REDUCED_STEP_NODES], sums are filled. False: too many parts.
 */
bool rb_reduced_step_take(struct rb_reduced_step *s, double h_s);

/* As the step begins: m/s, m/s^2, the largest speed and acceleration of a point of the bodies. */
double rb_reduced_step_speed(struct rb_reduced_step *s);
double rb_reduced_step_acceleration(struct rb_reduced_step *s);

/* I v of a body in world axes: kg m^2/s if v is a spin. */
rb_vec3 rb_reduced_step_times_inertia(const struct rb_model *model, int i, rb_quat q, rb_vec3 v);

#endif
