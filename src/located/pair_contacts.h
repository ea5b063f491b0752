/* SPDX-License-Identifier: MIT */
/*
 * Contact points of two bodies on their arcs at a given time, and the time at which they touch.
 *
 * Spheres with spheres and planes are here, in closed form; convex bodies in located/convex_contact
 * and located/approach. `a` and `b` are body indices in any order, normals point from a to b.
 */
#ifndef RB_LOCATED_PAIR_CONTACTS_H
#define RB_LOCATED_PAIR_CONTACTS_H

#include "located/approach.h"
#include "located/convex_contact.h"
#include "located/relative.h"

/* Farthest point of a body from its centre of mass, m; of planes INFINITY. */
double rb_pair_extent(const struct rb_located *l, int i);

/*
 * True if the parabolas of the centres prove that b stays too far from a to touch, between `from`
 * and `until`. a must move; at_a is its parabola at `from`. False: undecided.
 */
bool rb_pair_remains_separated(const struct rb_located *l, int a, int b,
                               const struct rb_parabola *at_a, double from, double until);

/* The point at which they are nearest to each other. */
struct rb_contact_point rb_contact_point_at(const struct rb_located *l, int a, int b, double t);
/* The same with given poses instead of those of the arcs. */
struct rb_contact_point rb_contact_point_poses(const struct rb_located *l, int a, int b,
                                               const struct rb_pose *pose_a,
                                               const struct rb_pose *pose_b);

/*
 * All points within the band plus `slack`, m: for spheres with spheres and planes that of
 * rb_contact_point_at, if within; else whole manifolds, sorted by (parts, key), at most
 * RB_CONTACT_POINTS_MAX points. `a` < `b`. A point about to leave its features is replaced by the
 * one that takes over.
 */
int rb_pair_contact_points(const struct rb_located *l, int a, int b, double t, double slack,
                           struct rb_contact_point all[RB_CONTACT_POINTS_MAX]);

/*
 * The same contact point at other poses, by its features, wherever these are: a smooth function of
 * the poses. It does not search, so other touching points are not found; `inside` tells whether the
 * features are still valid.
 */
struct rb_contact_point rb_contact_point_of(const struct rb_located *l,
                                            const struct rb_contact_name *name,
                                            const struct rb_pose *pose_a,
                                            const struct rb_pose *pose_b);

/*
 * True if they approach faster than rounding. Prediction and impact must decide alike: an approach
 * that an impact ignores must not be predicted as one.
 */
bool rb_contact_point_approaches(const struct rb_located *l, int a, int b, double t);

/* True if contacts between these two are possible at all. */
bool rb_pair_can_touch(const struct rb_located *l, int a, int b);

/*
 * True if they certainly do not touch from `from` to `until`, which is within their pieces. Cheap;
 * considers infinite planes only at rest.
 */
bool rb_pair_is_far(const struct rb_located *l, int a, int b, double from, double until);

/*
 * First time in [from, until] at which they touch and approach, INFINITY: none. Closed forms for
 * spheres in flight under the same acceleration, and for a sphere in flight and a plane at rest;
 * else conservative steps that end on the root: the distance of a point to a convex set is convex
 * along a straight line, so with the relative acceleration bounded by A, gap(t + h) >= gap + rate h
 * - A h^2 / 2. In `*found`, `unfinished` is set if the time is no touch but where the search must
 * continue; `products` is increased by the cost of these steps, or set to that of the search by
 * features.
 */
double rb_pair_contact_time(const struct rb_located *l, int a, int b, double from, double until,
                            struct rb_approach *found);

#endif
