/* SPDX-License-Identifier: MIT */
/*
 * How two bodies on their arcs stand to each other at a moment, and when they touch.
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
 * Does b stay farther from a than they could touch at, from `from` to `until`, by the parabolas of
 * their centres? a moves, that is its parabola at `from`. False: not known.
 */
bool rb_pair_keeps_off(const struct rb_located *l, int a, int b, const struct rb_parabola *at_a,
                       double from, double until);

/* The point at which they are nearest to each other. */
struct rb_contact_point rb_contact_point_at(const struct rb_located *l, int a, int b, double t);
/* The same with poses that are not (yet) those of the arcs. */
struct rb_contact_point rb_contact_point_poses(const struct rb_located *l, int a, int b,
                                               const struct rb_pose *pose_a,
                                               const struct rb_pose *pose_b);

/*
 * All points within the band, and `slack` more (m): of spheres with spheres and planes the one of
 * rb_contact_point_at, where it is; else whole manifolds, sorted by (parts, key); beyond
 * RB_CONTACT_POINTS_MAX points are left out. `a` < `b`. Where a point is about to leave its
 * features, the one that takes over is there instead.
 */
int rb_pair_contact_points(const struct rb_located *l, int a, int b, double t, double slack,
                           struct rb_contact_point all[RB_CONTACT_POINTS_MAX]);

/*
 * The same contact point at other poses, by its features, wherever these are: a smooth function of
 * the poses. No search, so what else may touch is not seen; `inside` says how long the features are
 * right.
 */
struct rb_contact_point rb_contact_point_of(const struct rb_located *l,
                                            const struct rb_contact_name *name,
                                            const struct rb_pose *pose_a,
                                            const struct rb_pose *pose_b);

/*
 * Do they approach by more than that? What an impact does not take for an approach must not be
 * foreseen as one.
 */
bool rb_contact_point_approaches(const struct rb_located *l, int a, int b, double t);

/* Whether contacts between these two are possible at all. */
bool rb_pair_can_touch(const struct rb_located *l, int a, int b);

/*
 * Surely not touching from `from` to `until`, neither of them beyond its piece? Cheap; of infinite
 * planes only those at rest.
 */
bool rb_contact_point_is_far(const struct rb_located *l, int a, int b, double from, double until);

/*
 * First moment in [from, until] at which they touch and approach, INFINITY: none. Closed forms for
 * spheres that fly under the same acceleration and for a sphere in flight and a plane at rest; else
 * conservative steps that end on the root: the distance of a point to a convex set is convex along
 * a straight line, so with the relative acceleration bounded by A, gap(t + h) >= gap + rate h - A
 * h^2 / 2. Of `*found`, `again` is set when the moment is not yet a touch but where to look again;
 * `products` grows by what these steps have cost, or is what features have.
 */
double rb_pair_contact_time(const struct rb_located *l, int a, int b, double from, double until,
                            struct rb_approach *found);

#endif
