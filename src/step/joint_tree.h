/* SPDX-License-Identifier: MIT */
/*
 * Accelerations of bodies whose joints form trees, in reduced coordinates (articulated bodies),
 * without an unknown per joint.
 *
 * From the leaves to the roots, the response of a body and its subtree to accelerations is an
 * articulated inertia of six by six, from which the degrees of freedom of the joint to the parent
 * are eliminated; from the roots to the leaves accelerations follow (Featherstone, Int. J. Robotics
 * Research 2 (1983) 13). Each joint costs the same, a hinge an eighth of its five rows in
 * located/coupled. Unknowns are the changes of accelerations by constraints: those of free fall are
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

/* A degree of freedom of a joint: its motion, and the inertia times it. */
struct rb_freedom {
	struct rb_screw motion, answer;
	double inverse; /* of motion . answer */
	double force;   /* motion . bias */
	double rate;    /* acceleration of the coordinate, m/s^2 or rad/s^2 */
};

/* A body and the joint to its parent. */
struct rb_joint_tree_link {
	int place, parent; /* parent: an earlier link; -1: none, or a static or driven body */
	int joint;         /* of the model; -1: a free root */
	bool is_b;         /* the body is the joint's b */
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
	struct rb_screw given; /* acceleration relative to the parent, without free coordinates */
	rb_lanes from_parent;  /* m: from its centre of mass to the link's */
	struct rb_joint_tree_inertia whole; /* articulated */
	struct rb_screw bias;               /* force at zero acceleration */
	struct rb_screw added;              /* change of acceleration by joints */
};

struct rb_joint_tree {
	const struct rb_model *model;
	const struct rb_joint_state *state; /* by joint: which are released */
	const int *body;                    /* [body_count] by place */
	const struct rb_pose *pose;         /* [body_count] by place: now and later */
	int body_count;
	const int *place; /* by body below `placed`; arbitrary for bodies that are not members */
	int placed;
	/* pose of a static or driven end at a time; for -1 the world's */
	struct rb_pose (*fixed_pose)(const void *user, int body, double t);
	const void *user;
	struct rb_joint_tree_link *link; /* [body_count]: parents first */
	struct rb_freedom *freedom;      /* [3 body_count] */
	int count;                       /* of links */
};

/*
 * Builds the trees of all bodies; `link_of`: [body_count]. The rest of the struct must be filled.
 */
void rb_joint_tree_grow(struct rb_joint_tree *tree, int *link_of);

/* Pose of the parent of a link with a joint. */
struct rb_pose rb_joint_tree_parent(const struct rb_joint_tree *tree,
                                    const struct rb_joint_tree_link *link, double t);

/* Adds the changes by joints to accelerations without joints, by place. */
void rb_joint_tree_accelerate(struct rb_joint_tree *tree, double t, rb_vec3 *linear,
                              rb_vec3 *angular);

/* After rb_joint_tree_accelerate: adds the external forces of joints to rates by cause. */
void rb_joint_tree_enter(const struct rb_joint_tree *tree, struct rb_entries *rate);

#endif
