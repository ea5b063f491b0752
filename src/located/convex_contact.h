/* SPDX-License-Identifier: MIT */
/*
 * Contact points of pairs with at least one convex body that is no sphere: box, capsule, cylinder,
 * hull, union. geom/manifold finds them, located/feature describes their motion.
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
 * The flat rim on a surface of which the contact point is a quarter, relative to the centre of mass
 * of m->a. False: it is none.
 */
bool rb_touch_rim_of(const struct rb_located *l, const struct rb_contact_point *m,
                     struct rb_feature_flat_rim *rim);
/* The contact point of the same surfaces on the rim in direction `direction`, world axes. */
struct rb_contact_point rb_touch_on_rim(const struct rb_located *l,
                                        const struct rb_contact_point *m,
                                        const struct rb_feature_flat_rim *rim, rb_vec3 direction);
struct rb_contact_point rb_touch_nearest(const struct rb_located *l, int a, int b,
                                         const struct rb_pose *pose_a,
                                         const struct rb_pose *pose_b);

/* The contact point by adjacent features, for a point that has left its own. */
struct rb_contact_point rb_touch_passed_on(const struct rb_located *l,
                                           const struct rb_contact_point *m);

/* Two bodies with given poses at a time. */
struct rb_touch_pair {
	int a, b;
	double t;
	struct rb_pose pose_a, pose_b;
};
int rb_touch_all(const struct rb_located *l, const struct rb_touch_pair *pair, double slack,
                 struct rb_contact_point all[RB_CONTACT_POINTS_MAX]);

/* Signed gap of the pair, over all parts, m; *parts: the nearest ones. */
double rb_touch_gap(const struct rb_located *l, const struct rb_touch_pair *pair, uint32_t *parts);

/*
 * A part of a body in this pose, relative to the centre of mass at `reference`, m; NULL: relative
 * to the body's own.
 */
struct rb_body_part;
void rb_touch_side(const struct rb_located *l, int i, int part, const struct rb_pose *pose,
                   const struct rb_pose *reference, struct rb_feature_side *side);

#endif
