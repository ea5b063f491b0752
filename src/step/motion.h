/* SPDX-License-Identifier: MIT */
/*
 * What the function of a driven body says, and whether a body can move like that: without jumps,
 * and as the velocities say that it returns. Steps and pieces only look at some moments of it.
 */
#ifndef RB_STEP_MOTION_H
#define RB_STEP_MOTION_H

#include "world/world.h"

/* Of the two quaternions of an orientation, the one on the side of `near`. */
RB_CHECKED enum rb_status rb_motion_ask(const struct rb_world *world, int i, double t, rb_quat near,
                                        struct rb_driven_pose *pose, struct rb_error *err);

/* What a body is said to do from one moment to another. */
struct rb_motion {
	const struct rb_world *world;
	int i;
	double from_s, to_s;
	struct rb_driven_pose begin, end;
	/* share of the smallest body's size, of a radian: less than that is not seen */
	double coarse;
	double agreement; /* share of the way by which velocities and places may differ */
};

/*
 * Looks within it, closer where it is not smooth. RB_ERR_SCENE, with the moment and by how much: it
 * jumps, or velocities contradict the places. Kinks are none of these. Velocities count where begin
 * and end have them.
 */
RB_CHECKED enum rb_status rb_motion_watch(const struct rb_motion *motion, struct rb_error *err);

#endif
