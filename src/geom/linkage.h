/* SPDX-License-Identifier: MIT */
/*
 * Geometry of a joint at two poses: what its rows of constraint say.
 *
 * Pure functions of a sealed joint and two poses; the world as the other body stands still at the
 * origin of all coordinates (rb_linkage_world). With x the centre of mass, r the arm of the joint's
 * point from it, p = x + r, d = p_b - p_a, u_1 u_2 u_3 the joint's axes of a and w_3 that of b:
 *
 *     rows of                                     error C
 *     a point: fixed, ball, hinge, universal      d, along the world's axes          3
 *     a line: slider, cylindrical                 u_1 . d, u_2 . d                   2
 *     one axis: hinge, cylindrical                u_1 . w_3, u_2 . w_3               2
 *     axes across: universal                      u_3 . w_3                          1
 *     one orientation: fixed, slider              2 v of the small rotation (s, v)   3
 *     a length: rod, rope                         |d| - L                            1
 *
 * in this order. Each row has velocity J V = dC/dt = l.(v_b - v_a) + m_a.w_a + m_b.w_b exactly, at
 * any pose, and bias J' V, so that d2C/dt2 = J A + bias. A multiplier h of it is the force h l at
 * b's centre of mass and the torque h m_b on b; the force -h l and the torque h m_a on a. Rows with
 * l = 0 are couples: errors in rad, multipliers N m. The others: m, N.
 *
 * The free coordinate: struct rb_joint_def. Its row has the same form and no error.
 */
#ifndef RB_GEOM_LINKAGE_H
#define RB_GEOM_LINKAGE_H

#include <rbsim/scene.h>

#include "math/pose.h"

enum { RB_LINKAGE_ROWS_MAX = 6 };

/* A joint as it is fixed to its bodies. */
struct rb_linkage {
	enum rb_joint_kind kind;
	rb_vec3 at_a, at_b; /* m, from the centres of mass, object axes */
	/*
	 * From the joint's axes to object axes; z is the joint's axis. At the start they are equal
	 * in the world, but of universal joints, of which each has its own.
	 */
	rb_quat frame_a, frame_b;
	double length; /* m, of rods and ropes */
};

struct rb_linkage_row {
	rb_vec3 linear;               /* l: a unit vector, or 0 */
	rb_vec3 angular_a, angular_b; /* m_a, m_b: m, or 1 where l is 0 */
	double error;                 /* C: m, or rad where l is 0 */
	double bias;                  /* m/s^2 or rad/s^2 */
};

/* The pose of the world as the second body of a joint. */
struct rb_pose rb_linkage_world(void);

/* How many rows a kind has: 6, 3, 5, 5, 4, 4, 1, 1. */
int rb_linkage_row_count(enum rb_joint_kind kind);

/* True for a row of that number that turns only: its linear part is 0. */
bool rb_linkage_row_is_couple(enum rb_joint_kind kind, int row);

/* Fills the rows, returns their number. A rod or rope of length 0 at that moment: along z. */
int rb_linkage_rows(const struct rb_linkage *link, const struct rb_pose *a, const struct rb_pose *b,
                    struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX]);

/* dC/dt of a row, m/s or rad/s. */
double rb_linkage_row_velocity(const struct rb_linkage_row *row, const struct rb_pose *a,
                               const struct rb_pose *b);

/* Has the kind a free coordinate? Hinge: an angle; slider, cylindrical: a way. */
static inline bool rb_linkage_has_free(enum rb_joint_kind kind)
{
	return kind == RB_JOINT_HINGE || kind == RB_JOINT_SLIDER || kind == RB_JOINT_CYLINDRICAL;
}

/* The free coordinate at a moment; of kinds that have one. */
struct rb_linkage_free {
	double value; /* m; rad in [-pi, pi]: see rb_linkage_angle_near */
	double rate;  /* m/s, rad/s */
	/* along it: a multiplier is the force or torque of a motor; `error` 0; bias: of the rate */
	struct rb_linkage_row row;
};
struct rb_linkage_free rb_linkage_free(const struct rb_linkage *link, const struct rb_pose *a,
                                       const struct rb_pose *b);

/* The angle that differs from `angle` by whole turns and is nearest to `near`. */
double rb_linkage_angle_near(double angle, double near);

/* The joint's point of a and of b, world coordinates, and its axis (unit), of a. */
rb_vec3 rb_linkage_point_a(const struct rb_linkage *link, const struct rb_pose *a);
rb_vec3 rb_linkage_point_b(const struct rb_linkage *link, const struct rb_pose *b);
rb_vec3 rb_linkage_axis(const struct rb_linkage *link, const struct rb_pose *a);

#endif
