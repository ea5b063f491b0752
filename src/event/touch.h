/* SPDX-License-Identifier: MIT */
/*
 * Contact points of pairs in which a convex body is that is no sphere, or two such: box, capsule, cylinder, hull, union. By
 * geom/manifold, which finds them, and event/feature, which says how they move.
 */
#ifndef RB_EVENT_TOUCH_H
#define RB_EVENT_TOUCH_H

#include "event/meeting.h"

enum { RB_MEET_MAX = 64 };

/* See rb_meet_of, rb_meet_poses, rb_meet_all in event/meet.h. */
struct rb_meet rb_touch_of(const struct rb_located *l, const struct rb_meet_name *name,
                           const struct rb_pose *pose_a, const struct rb_pose *pose_b);
/* See rb_feature_half. */
bool rb_touch_half(const struct rb_located *l, const struct rb_meet *m, rb_vec3 *half);
struct rb_meet rb_touch_nearest(const struct rb_located *l, int a, int b,
                                const struct rb_pose *pose_a, const struct rb_pose *pose_b);

/* A point that has left its features, by those that it is passed on to. */
struct rb_meet rb_touch_passed_on(const struct rb_located *l, const struct rb_meet *m);

/* Two bodies at a moment, in poses of their own. */
struct rb_touch_pair {
	int a, b;
	double t;
	struct rb_pose pose_a, pose_b;
};
int rb_touch_all(const struct rb_located *l, const struct rb_touch_pair *pair, double slack,
                 struct rb_meet all[RB_MEET_MAX]);

/* m: signed gap of the pair, of all its parts; which of these are nearest. */
double rb_touch_gap(const struct rb_located *l, const struct rb_touch_pair *pair, uint32_t *parts);

/* A part of a body in this pose, seen from the centre of mass of another, m; NULL: of its own. */
struct rb_body_part;
struct rb_feature_side;
void rb_touch_side(const struct rb_located *l, int i, int part, const struct rb_pose *pose,
                   const struct rb_pose *reference, struct rb_feature_side *side);

#endif
