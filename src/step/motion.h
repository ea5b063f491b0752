/* SPDX-License-Identifier: MIT */
/*
 * Evaluation and checks of a driven body's function of time: it must be continuous, and consistent
 * with the velocities that it returns. Steps and pieces sample it only at some times. The function
 * that the motor of a joint follows is checked likewise: as the x of a position.
 */
#ifndef RB_STEP_MOTION_H
#define RB_STEP_MOTION_H

#include "world/world.h"

/*
 * Evaluates the function; of the two quaternions of an orientation, it returns the one on the side
 * of `near`.
 */
RB_CHECKED enum rb_status rb_motion_ask(const struct rb_world *world, int i, double t, rb_quat near,
                                        struct rb_driven_pose *pose, struct rb_error *err);

/*
 * Evaluates the target of a joint's motor: the angle, rad, or displacement, m, is pose->position.x,
 * its rate velocity.x.
 */
RB_CHECKED enum rb_status rb_motion_ask_motor(const struct rb_world *world, int joint, double t,
                                              struct rb_driven_pose *pose, struct rb_error *err);

/*
 * Size relative to which jumps are detected: that of the smallest body, m; for a hinge's motor 1
 * rad.
 */
double rb_motion_size(const struct rb_world *world, int i, bool motor);

/*
 * Beginning of messages, such as "scene.lua:2: 'motion' of 'lid'" or "scene.lua:3: 'angle' of the
 * motor of hinge 'knee'"; written to `out` and returned.
 */
enum { RB_MOTION_LABEL = 224 };
const char *rb_motion_label(const struct rb_world *world, int i, bool motor,
                            char out[RB_MOTION_LABEL]);

/* A driven body's motion from one time to another. */
struct rb_motion {
	const struct rb_world *world;
	int i;
	bool motor; /* i is a joint's number: the target of its motor */
	double from_s, to_s;
	struct rb_driven_pose begin, end;
	/* share of the smallest body's size, or of a radian, below which nothing is detected */
	double coarse;
	double agreement; /* share of the displacement; error of velocities against positions */
	struct rb_driven_pose *middle; /* out: halfway in time; NULL: not wanted */
};

/*
 * Samples the interval, more densely where it is not smooth. RB_ERR_SCENE, with time and amount: a
 * jump, or velocities that contradict the positions. Kinks are allowed. Velocities are checked if
 * begin and end have them.
 */
RB_CHECKED enum rb_status rb_motion_watch(const struct rb_motion *motion, struct rb_error *err);

#endif
