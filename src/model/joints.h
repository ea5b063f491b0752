/* SPDX-License-Identifier: MIT */
/*
 * Joints of a model: those of the scene, completed and sealed; who is at their ends; who does not
 * touch whom because of them.
 *
 * Points and frames are kept in object axes from the centres of mass (geom/linkage): methods ask
 * nothing but poses of centres of mass. Where b is the world they are world coordinates.
 */
#ifndef RB_MODEL_JOINTS_H
#define RB_MODEL_JOINTS_H

#include <rbsim/model.h>

#include "geom/linkage.h"
#include "model/joint_type.h"

enum { RB_JOINT_FAULT_SIZE = 320 };

struct rb_joint {
	struct rb_linkage link;
	int a, b; /* indices of bodies; b -1: the world */
	int def;  /* its place in scene->joints, and here */
	/* of the free coordinate, rad or m; infinite: none. Of ropes: of |d|, 0 and the length */
	double low, high;
	double restitution, friction; /* friction: N m or N */
	bool has_motor;
	double motor_speed; /* NAN: it follows motor_function */
	int motor_function;
	double motor_max;
	double stiffness, damping, rest;
	bool collides;
	double size; /* m: of what it joins, to which errors are relative; makes torques forces */
};

/*
 * What keeps a free coordinate at a speed with a force or torque within bounds: a motor, or
 * friction, whose speed is 0. A motor of speed 0 is a brake: it is one with the friction.
 */
enum rb_joint_drive_kind { RB_DRIVE_MOTOR, RB_DRIVE_FRICTION, RB_JOINT_DRIVES };
struct rb_joint_drive {
	double speed; /* rad/s or m/s */
	double max;   /* N m or N; 0: there is none */
};
/* `motor`: as it is now; max 0: there is none. */
static inline struct rb_joint_drive rb_joint_drive(const struct rb_joint *joint,
                                                   struct rb_joint_drive motor_now, int kind)
{
	const bool brakes = motor_now.max > 0 && motor_now.speed == 0;
	const double motor = motor_now.max;

	if (kind == RB_DRIVE_MOTOR)
		return (struct rb_joint_drive){motor_now.speed, brakes ? 0 : motor};
	return (struct rb_joint_drive){0, joint->friction + (brakes ? motor : 0)};
}

struct rb_joints {
	int count;
	struct rb_joint *joint; /* owned */
	/* owned: those at body i are of[first[i] .. first[i + 1]), ascending; statics too */
	int *first, *of;
};

/* Force or torque of the joint's spring and damper along its free coordinate, N or N m. */
static inline double rb_joint_spring(const struct rb_joint *joint, double value, double rate)
{
	return -joint->stiffness * (value - joint->rest) - joint->damping * rate;
}

/* What is wrong with the joint by itself or with its bodies at the start; false: nothing. */
bool rb_joint_fault(const struct rb_scene *scene, const struct rb_joint_def *def,
                    char text[RB_JOINT_FAULT_SIZE]);

/* "hinge 'knee'", "rod #3" for messages; written to `out`, which is returned. */
/*
 * The file and line that made it, for the beginning of a message: "file:line: "; empty where they
 * are not known.
 */
const char *rb_joint_source(const struct rb_scene *scene, int k, char out[96]);

const char *rb_joint_label(const struct rb_scene *scene, int k, char out[96]);

/* Whether it can turn one of its bodies: only rods and ropes at centres of mass cannot. */
bool rb_joint_turns(const struct rb_scene *scene, const struct rb_joint_def *def);

/*
 * Its points, world coordinates at the start, as given: p_a = `at` or that of `at_a`, p_b likewise,
 * or each that of the other; of rods and ropes centres of mass where nothing is given.
 */
void rb_joint_points(const struct rb_scene *scene, const struct rb_joint_def *def, rb_vec3 *p_a,
                     rb_vec3 *p_b);

/* m: the largest of the distances of its points from the bodies' origins and of their sizes. */
double rb_joint_size(const struct rb_scene *scene, const struct rb_joint_def *def);

/* m: the most by which a joint of that size may be open at the start, or a callback opens it. */
double rb_joint_allowed(double size, rb_vec3 p_a, rb_vec3 p_b);

/* Whether a joint without `collides` is between the two bodies of the scene (ids). */
bool rb_scene_joined(const struct rb_scene *scene, int a, int b);

/* model->joints, from the scene's, which have no fault; bodies must be numbered. */
RB_CHECKED enum rb_status rb_joints_create(struct rb_model *model, struct rb_error *err);
void rb_joints_destroy(struct rb_model *model);

/* Whether the two bodies (indices) are neighbours that do not touch: see rb_model_joined. */
bool rb_joints_between(const struct rb_joints *joints, int a, int b);

/* The filter of every search for contacts. Without joints one comparison. */
static inline bool rb_model_joined(const struct rb_model *model, int a, int b)
{
	return model->joints && rb_joints_between(model->joints, a, b);
}

#endif
