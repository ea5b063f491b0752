/* SPDX-License-Identifier: MIT */
/*
 * Accelerations of bodies whose joints form trees, without an unknown of any joint.
 *
 * From the leaves on, what a body and all that hangs on it answers to accelerations is an inertia
 * of six by six, the articulated one, of which what the joint to the next body leaves free is taken
 * away; from the roots on accelerations follow (Featherstone, Int. J. Robotics Research 2 (1983)
 * 13). Each joint costs the same, a hinge an eighth of its five rows in located/coupled. Unknowns
 * are what constraints add to the accelerations that bodies have without: those of free fall are
 * exact.
 *
 * Arrays are the caller's; trees may be used by one thread each.
 */
#ifndef RB_STEP_JOINT_TREE_H
#define RB_STEP_JOINT_TREE_H

#include "math/lanes.h"
#include "model/joints.h"
#include "world/joint_state.h"
#include "world/world.h"

/* Velocity (or acceleration) of the centre of mass and spin; or force and torque about it. */
struct rb_screw {
	rb_lanes linear, angular;
};

/* Force = mass a + cross b, torque = back a + turning b; symmetric: back is cross transposed. */
struct rb_joint_tree_inertia {
	rb_lanes mass[3], cross[3], back[3], turning[3];
};

/* A motion that a joint leaves free, and what the inertia is to it. */
struct rb_freedom {
	struct rb_screw motion, answer;
	double inverse; /* of motion . answer */
	double force;   /* motion . bias */
	double rate;    /* acceleration of the coordinate, m/s^2 or rad/s^2 */
};

/* A body, and the joint to the one that it hangs on. */
struct rb_joint_tree_link {
	int place, parent; /* parent: a link before it, -1: none, or what stands still */
	int joint;         /* of the model; -1: it hangs on nothing */
	bool is_b;         /* of the joint */
	bool is_isotropic;
	unsigned free;       /* enum rb_linkage_freedom */
	rb_vec3 arm;         /* to the joint's point, m, object axes */
	rb_vec3 axis;        /* of the joint, object axes */
	rb_vec3 parent_axis; /* that of the parent, its object axes */
	double mass;
	rb_lanes own[3]; /* kg m^2, object axes */
	/* at the poses, world axes */
	struct rb_freedom *freedom;
	int freedom_count;
	struct rb_screw given; /* acceleration against the parent, but for what is free */
	rb_lanes from_parent;  /* m: from its centre of mass to the link's */
	struct rb_joint_tree_inertia whole; /* articulated */
	struct rb_screw bias;               /* the force that it takes without any acceleration */
	struct rb_screw added;              /* accelerations by joints */
};

struct rb_joint_tree {
	const struct rb_model *model;
	const struct rb_joint_state *state; /* by joint: which are released */
	const int *body;                    /* [body_count] by place */
	const struct rb_pose *pose;         /* [body_count] by place: now and later */
	int body_count;
	const int *place; /* by body, of those below `placed`; of others than these: anything */
	int placed;
	/* the pose of an end that does not yield, at a time; of -1 it is the world's */
	struct rb_pose (*fixed_pose)(const void *user, int body, double t);
	const void *user;
	struct rb_joint_tree_link *link; /* [body_count]: after those that they hang on */
	struct rb_freedom *freedom;      /* [3 body_count] */
	int count;                       /* of links */
};

/* Trees of all bodies; `link_of`: [body_count]. The rest of the struct is filled. */
void rb_joint_tree_grow(struct rb_joint_tree *tree, int *link_of);

/* The pose of what a link with a joint hangs on. */
struct rb_pose rb_joint_tree_parent(const struct rb_joint_tree *tree,
                                    const struct rb_joint_tree_link *link, double t);

/* Adds to accelerations, by place, which are those without joints, what joints make of them. */
void rb_joint_tree_accelerate(struct rb_joint_tree *tree, double t, rb_vec3 *linear,
                              rb_vec3 *angular);

/* After rb_joint_tree_accelerate: what joints exert from outside, added to rates by cause. */
void rb_joint_tree_enter(const struct rb_joint_tree *tree, struct rb_entries *rate);

#endif
