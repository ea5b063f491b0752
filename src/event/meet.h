/* SPDX-License-Identifier: MIT */
/*
 * How two bodies on their arcs stand to each other at a moment, and when they touch.
 *
 * A new shape adds its row to the table in meet.c. Of a pair, one at least is a sphere; `a` and `b` are body indices in
 * any order, normals point from a to b.
 */
#ifndef RB_EVENT_MEET_H
#define RB_EVENT_MEET_H

#include "event/arc.h"

struct rb_meet {
	int a, b;
	double gap;          /* m */
	rb_vec3 normal;      /* unit, from a to b */
	rb_vec3 normal_rate; /* 1/s: its derivative */
	rb_vec3 point;       /* m, world: of the contact, on the sphere's surface */
	bool on_rim;         /* at an edge or corner of a rectangle */
	struct rb_pose pose_a, pose_b;
	rb_vec3 arm_a, arm_b;   /* m, centres of mass to the point */
	rb_vec3 rate_a, rate_b; /* m/s: derivatives of the arms as the point moves along */
	rb_vec3 velocity;       /* m/s, of b's material at the point relative to a's */
};

struct rb_meet rb_meet_at(const struct rb_located *l, int a, int b, double t);
/* The same with poses that are not (yet) those of the arcs. */
struct rb_meet rb_meet_poses(const struct rb_located *l, int a, int b, const struct rb_pose *pose_a,
                             const struct rb_pose *pose_b);

/* m: radius of the larger sphere of the two; a plane has no size, and its own point may be anywhere. */
double rb_meet_size(const struct rb_located *l, const struct rb_meet *m);
/* m: gaps up to here count as touching (rbsim-scene(5), TOUCHING AND AT REST), at this approach and moment. */
double rb_meet_band(const struct rb_located *l, const struct rb_meet *m, double t);
/* m/s: rounding of the normal velocity, of speeds and of what weight makes of them in a fall by its own size. */
double rb_meet_noise(const struct rb_located *l, const struct rb_meet *m);

/* m/s^2: second derivative of the gap, on the arcs as they are at `t`, with the poses of the meeting. */
double rb_meet_bend(const struct rb_located *l, const struct rb_meet *m, double t);
/* Do they approach by more than that? What an impact does not take for an approach must not be foreseen as one. */
bool rb_meet_approaches(const struct rb_located *l, int a, int b, double t);

/* Whether contacts between these two are possible at all. */
bool rb_meet_can(const struct rb_located *l, int a, int b);

/* Surely not touching from `from` to `until`, neither of them beyond its piece? Cheap, and not where a plane is infinite. */
bool rb_meet_is_far(const struct rb_located *l, int a, int b, double from, double until);

/*
 * First moment in [from, until] at which they touch and approach, INFINITY: none. Closed forms for spheres that fly
 * under the same acceleration and for a sphere in flight and a plane at rest; else conservative steps that end on the
 * root: the distance of a point to a convex set is convex along a straight line, so with the relative acceleration
 * bounded by A, gap(t + h) >= gap + rate h - A h^2 / 2. `*again` is set when the moment is not yet a touch but where to look
 * again.
 */
double rb_meet_time(const struct rb_located *l, int a, int b, double from, double until,
                    bool *again);

#endif
