/* SPDX-License-Identifier: MIT */
/*
 * Contact points of pairs in which a convex body is that is no sphere, or two such: box, capsule,
 * cylinder, hull, union. By geom/manifold, which finds them, and located/feature, which says how
 * they move.
 */
#ifndef RB_LOCATED_CONVEX_CONTACT_H
#define RB_LOCATED_CONVEX_CONTACT_H

#include "located/contact_point.h"
#include "located/feature_side.h"

enum { RB_CONTACT_POINTS_MAX = 64 };

/*
 * See rb_contact_point_of, rb_contact_point_poses, rb_pair_contact_points in
 * located/pair_contacts.h.
 */
struct rb_contact_point rb_touch_of(const struct rb_located *l, const struct rb_contact_name *name,
                                    const struct rb_pose *pose_a, const struct rb_pose *pose_b);
/* See rb_feature_half. */
bool rb_touch_half(const struct rb_located *l, const struct rb_contact_point *m, rb_vec3 *half);
/*
 * The flat rim on a surface of which the contact point is a quarter, seen from the centre of mass
 * of m->a. False: it is none.
 */
bool rb_touch_rim_of(const struct rb_located *l, const struct rb_contact_point *m,
                     struct rb_feature_flat_rim *rim);
/* The contact point of the same surfaces that lies on the rim in this direction, in world axes. */
struct rb_contact_point rb_touch_on_rim(const struct rb_located *l,
                                        const struct rb_contact_point *m,
                                        const struct rb_feature_flat_rim *rim, rb_vec3 way);
struct rb_contact_point rb_touch_nearest(const struct rb_located *l, int a, int b,
                                         const struct rb_pose *pose_a,
                                         const struct rb_pose *pose_b);

/* A point that has left its features, by those that it is passed on to. */
struct rb_contact_point rb_touch_passed_on(const struct rb_located *l,
                                           const struct rb_contact_point *m);

/* Two bodies at a moment, in poses of their own. */
struct rb_touch_pair {
	int a, b;
	double t;
	struct rb_pose pose_a, pose_b;
};
int rb_touch_all(const struct rb_located *l, const struct rb_touch_pair *pair, double slack,
                 struct rb_contact_point all[RB_CONTACT_POINTS_MAX]);

/* m: signed gap of the pair, of all its parts; which of these are nearest. */
double rb_touch_gap(const struct rb_located *l, const struct rb_touch_pair *pair, uint32_t *parts);

/* A part of a body in this pose, seen from the centre of mass of another, m; NULL: of its own. */
struct rb_body_part;
void rb_touch_side(const struct rb_located *l, int i, int part, const struct rb_pose *pose,
                   const struct rb_pose *reference, struct rb_feature_side *side);

#endif
