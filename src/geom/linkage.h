/* SPDX-License-Identifier: MIT */
/*
 * Geometry of a joint at two poses: what its rows of constraint say.
 *
 * Pure functions of a sealed joint and two poses; the world as the other body stands still at the
 * origin of all coordinates (rb_linkage_world). With x the centre of mass, r the arm of the joint's
 * point from it, p = x + r, d = p_b - p_a, u_1 u_2 u_3 the joint's axes of a and w_3 that of b, a
 * kind of joint (joint/) states one or two conditions, here or in its own file:
 *
 *     condition                rows, error C                                   number
 *     rb_linkage_same_point    d, along the world's axes                       3
 *     rb_linkage_on_axis       u_1 . d, u_2 . d                                2
 *     rb_linkage_same_axis     u_1 . w_3, u_2 . w_3                            2
 *     rb_linkage_same_turn     2 v of the small rotation (s, v) from a to b    3
 *     rb_linkage_length        |d| - L                                         1
 *
 * in the order of its row. Each row has velocity J V = dC/dt = l.(v_b - v_a) + m_a.w_a + m_b.w_b
 * exactly, at any pose, and bias J' V, so that d2C/dt2 = J A + bias. A multiplier h of it is the
 * force h l at b's centre of mass and the torque h m_b on b; the force -h l and the torque h m_a on
 * a. Rows with l = 0 are couples: errors in rad, multipliers N m. The others: m, N.
 *
 * The free coordinate: struct rb_joint_def. Its row has the same form and no error.
 */
#ifndef RB_GEOM_LINKAGE_H
#define RB_GEOM_LINKAGE_H

#include <rbsim/scene.h>

#include "math/pose.h"

enum { RB_LINKAGE_ROWS_MAX = 6 };

struct rb_linkage;
struct rb_linkage_row;

/* What rows are made of, at two poses. */
struct rb_linkage_parts {
	const struct rb_pose *a, *b;
	rb_vec3 arm_a, arm_b; /* m, world axes */
	rb_vec3 d;            /* m, from a's point to b's */
	rb_vec3 rate;         /* m/s, of d */
	rb_vec3 centripetal;  /* m/s^2, of d, without accelerations */
	rb_quat turn_a;       /* from the joint's axes of a to the world */
	rb_vec3 spin;         /* rad/s, of b against a */
};

/* Rows that belong together. */
struct rb_linkage_condition {
	int count;
	bool couples; /* all of them turn only: their linear parts are 0 */
	void (*fill)(const struct rb_linkage *link, const struct rb_linkage_parts *parts,
	             struct rb_linkage_row *row);
};

extern const struct rb_linkage_condition rb_linkage_same_point, rb_linkage_on_axis,
	rb_linkage_same_axis, rb_linkage_same_turn, rb_linkage_length;

/*
 * What a joint is measured by. An angle or a way is its free coordinate: it has limits, a motor,
 * friction, a spring. A length is that of its first condition.
 */
enum rb_linkage_coordinate {
	RB_COORDINATE_NONE,
	RB_COORDINATE_ANGLE, /* about the axis, rad */
	RB_COORDINATE_WAY,   /* of b's point along the axis, m */
	RB_COORDINATE_LENGTH /* of the line between its points, m */
};

/*
 * What all rows of a kind together leave free, as motions of b against a. About both: about
 * the axes of a and of b, at right angles to each other.
 */
enum rb_linkage_freedom {
	RB_FREE_NOTHING = 1,
	RB_FREE_ALONG = 2, /* the axis */
	RB_FREE_ABOUT = 4, /* the axis */
	RB_FREE_ABOUT_BOTH = 8,
	RB_FREE_TURNING = 16 /* about the point */
};

/* The geometry of a kind of joint. At most RB_LINKAGE_ROWS_MAX rows, a point's before others. */
struct rb_linkage_type {
	const struct rb_linkage_condition *condition[2]; /* the second may be NULL */
	enum rb_linkage_coordinate coordinate;
	unsigned free;  /* of enum rb_linkage_freedom; 0: none of these says it */
	bool one_sided; /* its only row, no couple, holds C <= 0: it pulls and never pushes */
};

/* A joint as it is fixed to its bodies. */
struct rb_linkage {
	const struct rb_linkage_type *type;
	rb_vec3 at_a, at_b; /* m, from the centres of mass, object axes */
	/*
	 * From the joint's axes to object axes; z is the joint's axis. At the start they are equal
	 * in the world, but of kinds with an axis of b's, which is its z.
	 */
	rb_quat frame_a, frame_b;
	double length; /* m, of kinds whose coordinate is one */
};

struct rb_linkage_row {
	rb_vec3 linear;               /* l: a unit vector, or 0 */
	rb_vec3 angular_a, angular_b; /* m_a, m_b: m, or 1 where l is 0 */
	double error;                 /* C: m, or rad where l is 0 */
	double bias;                  /* m/s^2 or rad/s^2 */
};

/* The pose of the world as the second body of a joint. */
struct rb_pose rb_linkage_world(void);

static inline int rb_linkage_row_count(const struct rb_linkage *link)
{
	const struct rb_linkage_condition *const *condition = link->type->condition;

	return condition[0]->count + (condition[1] ? condition[1]->count : 0);
}

/* True for a row of that number that turns only: its linear part is 0. */
static inline bool rb_linkage_row_is_couple(const struct rb_linkage *link, int row)
{
	const struct rb_linkage_condition *const *condition = link->type->condition;

	return condition[row >= condition[0]->count]->couples;
}

/* Are its first three rows those of a point? */
static inline bool rb_linkage_has_point(const struct rb_linkage *link)
{
	return link->type->condition[0] == &rb_linkage_same_point;
}

/* Fills the rows, returns their number. A line of length 0 at that moment: along z. */
int rb_linkage_rows(const struct rb_linkage *link, const struct rb_pose *a, const struct rb_pose *b,
                    struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX]);

/* dC/dt of a row, m/s or rad/s. */
double rb_linkage_row_velocity(const struct rb_linkage_row *row, const struct rb_pose *a,
                               const struct rb_pose *b);

/* Its free coordinate is an angle, whose turns are counted. */
static inline bool rb_linkage_turns(const struct rb_linkage *link)
{
	return link->type->coordinate == RB_COORDINATE_ANGLE;
}

static inline bool rb_linkage_has_free(const struct rb_linkage *link)
{
	return rb_linkage_turns(link) || link->type->coordinate == RB_COORDINATE_WAY;
}

/* m: by how far its points are off, of rows that are no couples. */
double rb_linkage_gap(const struct rb_linkage *link, const struct rb_pose *a,
                      const struct rb_pose *b);

/* The free coordinate at a moment; of joints that have one. */
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

/* ---- for files of kinds that state a condition of their own ---- */

/* u.d for u, unit, that turns with a. */
struct rb_linkage_row rb_linkage_along(const struct rb_linkage_parts *parts, rb_vec3 u);

/* u.w for u that turns with a, w with b, units: a couple. */
struct rb_linkage_row rb_linkage_across(const struct rb_linkage_parts *parts, rb_vec3 u, rb_vec3 w);

/* Of the joint's axes, k 0 to 2, that one of a and of b; world axes. */
rb_vec3 rb_linkage_axis_a(const struct rb_linkage_parts *parts, int k);
rb_vec3 rb_linkage_axis_b(const struct rb_linkage *link, const struct rb_linkage_parts *parts,
                          int k);

#endif
