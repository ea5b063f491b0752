/* SPDX-License-Identifier: MIT */
/*
 * What the function of a driven body says, and whether a body can move like that: without jumps,
 * and as the velocities say that it returns. Steps and pieces only look at some moments of it. The
 * function that the motor of a joint follows is watched likewise: it is the x of a place.
 */
#ifndef RB_STEP_MOTION_H
#define RB_STEP_MOTION_H

#include "world/world.h"

/* Of the two quaternions of an orientation, the one on the side of `near`. */
RB_CHECKED enum rb_status rb_motion_ask(const struct rb_world *world, int i, double t, rb_quat near,
                                        struct rb_driven_pose *pose, struct rb_error *err);

/*
 * What the motor of a joint is to follow: the angle, rad, or way, m, is pose->position.x, its rate
 * velocity.x.
 */
RB_CHECKED enum rb_status rb_motion_ask_motor(const struct rb_world *world, int joint, double t,
                                              struct rb_driven_pose *pose, struct rb_error *err);

/* Distances from which jumps are seen: m, the smallest body's; of a hinge's motor 1 rad. */
double rb_motion_size(const struct rb_world *world, int i, bool motor);

/*
 * "scene.lua:2: 'motion' of 'lid'", "scene.lua:3: 'angle' of the motor of hinge 'knee'" to begin
 * messages with; written to `out`, returned.
 */
enum { RB_MOTION_LABEL = 224 };
const char *rb_motion_label(const struct rb_world *world, int i, bool motor,
                            char out[RB_MOTION_LABEL]);

/* What a body is said to do from one moment to another. */
struct rb_motion {
	const struct rb_world *world;
	int i;
	bool motor; /* i is a joint's number: what its motor follows */
	double from_s, to_s;
	struct rb_driven_pose begin, end;
	/* share of the smallest body's size, of a radian: less than that is not seen */
	double coarse;
	double agreement; /* share of the way by which velocities and places may differ */
	struct rb_driven_pose *middle; /* out: halfway in time; NULL: not asked for */
};

/*
 * Looks within it, closer where it is not smooth. RB_ERR_SCENE, with the moment and by how much: it
 * jumps, or velocities contradict the places. Kinks are none of these. Velocities count where begin
 * and end have them.
 */
RB_CHECKED enum rb_status rb_motion_watch(const struct rb_motion *motion, struct rb_error *err);

#endif
