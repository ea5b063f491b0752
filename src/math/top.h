/* SPDX-License-Identifier: MIT */
/*
 * Turning without torque, and with one that is constant in world axes, from an anchor: orientation
 * and angular velocity at any later moment, to rounding, whatever the moments that were asked for
 * before.
 *
 *   constant   equal moments: the spin stays
 *   steady     equal moments and a constant angular acceleration; closed form when parallel to the
 *              spin, else a series
 *   symmetric  two equal moments: closed form (precession about L, spin about the own axis)
 *   free       three unequal moments, or a frame of the tensor that is not diagonal: a Taylor
 *              series of Euler's equations and the quaternion's, carried to rounding over steps of
 *              a grid that starts at the anchor; far from it by whole periods, each of which turns
 *              the body about its angular momentum by the same angle
 *
 * The grid's last point is kept, so that going forward costs one step per grid interval; what comes
 * out does not depend on what was asked before.
 */
#ifndef RB_MATH_TOP_H
#define RB_MATH_TOP_H

#include <stdbool.h>
#include <stdint.h>

#include "base/field_list.h"
#include "math/mat3.h"
#include "math/quat.h"

enum rb_top_kind { RB_TOP_CONSTANT, RB_TOP_STEADY, RB_TOP_SYMMETRIC, RB_TOP_FREE };

/* From the anchor all else follows; what the cache holds is the same whenever it is asked for. */
#define RB_TOP_FIELDS(X)                                                                         \
	X(enum rb_top_kind, kind, , "", "", RB_DERIVED)                                          \
	X(rb_quat, orientation, , "1", "at the anchor; object to world", RB_FINITE)              \
	X(rb_vec3, spin, , "rad/s", "world axes, at the anchor", RB_FINITE)                      \
	X(rb_vec3, acceleration, , "rad/s^2", "world axes, for `steady`", RB_FINITE)             \
	X(rb_quat, principal, , "1",                                                             \
	  "principal axes to object coordinates, for symmetric and free", RB_DERIVED)            \
	X(rb_vec3, moments, , "kg m^2", "principal; for symmetric the distinct one is z",        \
	  RB_DERIVED)                                                                            \
	X(double, grid_s, , "s",                                                                 \
	  "free: length of a step of the series; steady: 0; INFINITY where there is no series",  \
	  RB_DERIVED)                                                                            \
	X(uint64_t, at, , "", "grid point that the cache holds", RB_DERIVED)                     \
	X(rb_quat, cached, , "1", "principal axes to world", RB_DERIVED)                         \
	X(rb_vec3, cached_spin, , "rad/s", "principal axes for `free`, world axes for `steady`", \
	  RB_DERIVED)                                                                            \
	X(double, period_s, , "s", "free: of the spin in principal axes; 0: not known yet",      \
	  RB_DERIVED)                                                                            \
	X(rb_vec3, precession, , "rad", "free: by which a period turns the body, world axes",    \
	  RB_DERIVED)
struct rb_top {
	RB_TOP_FIELDS(RB_FIELD_MEMBER)
};
RB_FIELDS_DECLARE(rb_top_fields);

/* What does not change with the state: principal axes of a tensor (object coordinates), kg m^2. */
struct rb_top_body {
	enum rb_top_kind kind; /* constant, symmetric or free */
	rb_quat principal;
	rb_vec3 moments;
};
struct rb_top_body rb_top_body_of(const rb_mat3 *inertia);

/*
 * H of a body's inverse tensor H^T H, world axes. Rows: principal axes in world coordinates over
 * the roots of their moments.
 */
rb_mat3 rb_top_inverse_root(const struct rb_top_body *body, const rb_mat3 *inertia,
                            rb_quat orientation);

/*
 * Angular acceleration without torque, rad/s^2, world axes: Euler's equations in the differences of
 * moments, none of which is larger than the moment that it is divided by. From w x I w the small
 * moment of a needle would magnify rounding.
 */
rb_vec3 rb_top_turning(const struct rb_top_body *body, const rb_mat3 *inertia, rb_quat orientation,
                       rb_vec3 spin);

/* A body let go at an anchor. `acceleration` must be zero unless the body's kind is constant. */
struct rb_top rb_top_start(const struct rb_top_body *body, rb_quat orientation, rb_vec3 spin,
                           rb_vec3 acceleration);

/* At `t` >= 0 seconds after the anchor. Either result may be NULL. */
void rb_top_at(struct rb_top *top, double t, rb_quat *orientation, rb_vec3 *spin);

/*
 * Walks on to `t`, by at most so many steps of a series: false where more are left. With it a
 * caller can hear what comes in while rb_top_at would not come back; only what is steady can take
 * that long.
 */
bool rb_top_follow(struct rb_top *top, double t, uint64_t steps);

/* s: a step of the series that follows this one, at its anchor; INFINITY: it needs none. */
double rb_top_step_s(const struct rb_top *top);

/*
 * Turns a body for `h` seconds without torque, for steps whose error is of their second order
 * anyhow: kinetic energy and angular momentum stay to rounding, and turning about a principal axis
 * is right for any step, but a free body's orientation is off by up to (w h)^3 / 12.
 */
void rb_top_step(const struct rb_top_body *body, double h, rb_quat *orientation, rb_vec3 *spin);

#endif
