/* SPDX-License-Identifier: MIT */
/*
 * Rotation without torque, and with one that is constant in world axes, from an anchor: orientation
 * and angular velocity at any later time, to rounding, independent of earlier queries.
 *
 *   constant   equal moments: constant spin
 *   steady     equal moments and a constant angular acceleration; closed form when parallel to the
 *              spin, otherwise a series
 *   symmetric  two equal moments: closed form (precession about L, spin about the own axis)
 *   free       three unequal moments, or a frame of the tensor that is not diagonal: a Taylor
 *              series of Euler's equations and the quaternion's, to rounding, over steps of a grid
 *              that starts at the anchor; far from it by whole periods, each of which rotates the
 *              body about its angular momentum by the same angle
 *
 * The last grid point is cached, so that advancing costs one step per grid interval; results do not
 * depend on earlier queries.
 */
#ifndef RB_MATH_TOP_H
#define RB_MATH_TOP_H

#include <stdbool.h>
#include <stdint.h>

#include "base/field_list.h"
#include "math/mat3.h"
#include "math/quat.h"

enum rb_top_kind { RB_TOP_CONSTANT, RB_TOP_STEADY, RB_TOP_SYMMETRIC, RB_TOP_FREE };

/* The anchor determines everything else; the cache has the same contents whenever it is filled. */
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

/* Constants of a body: principal axes of a tensor (object coordinates), kg m^2. */
struct rb_top_body {
	enum rb_top_kind kind; /* constant, symmetric or free */
	rb_quat principal;
	rb_vec3 moments;
};
struct rb_top_body rb_top_body_of(const rb_mat3 *inertia);

/*
 * Returns H of a body's inverse tensor H^T H, world axes. Its rows are the principal axes in world
 * coordinates divided by the roots of their moments.
 */
rb_mat3 rb_top_inverse_root(const struct rb_top_body *body, const rb_mat3 *inertia,
                            rb_quat orientation);

/*
 * Returns the angular acceleration without torque, rad/s^2, world axes: Euler's equations with
 * differences of moments, none of which is larger than the moment that it is divided by. With w x I
 * w, the small moment of a needle would amplify rounding.
 */
rb_vec3 rb_top_turning(const struct rb_top_body *body, const rb_mat3 *inertia, rb_quat orientation,
                       rb_vec3 spin);

/*
 * Returns the motion of a body from an anchor. `acceleration` must be zero unless the body's kind
 * is constant.
 */
struct rb_top rb_top_start(const struct rb_top_body *body, rb_quat orientation, rb_vec3 spin,
                           rb_vec3 acceleration);

/* Computes the state `t` >= 0 seconds after the anchor. Either result may be NULL. */
void rb_top_at(struct rb_top *top, double t, rb_quat *orientation, rb_vec3 *spin);

/*
 * Advances the cache towards `t`, by at most this many steps of a series; false: more remain.
 * Allows a caller to react to input during long advances, which are possible only for `steady`.
 */
bool rb_top_follow(struct rb_top *top, double t, uint64_t steps);

/* Length of a series step at the anchor, s; INFINITY: no series. */
double rb_top_step_s(const struct rb_top *top);

/*
 * Rotates a body for `h` seconds without torque, for steps with an error of second order: kinetic
 * energy and angular momentum are conserved to rounding, and rotation about a principal axis is
 * exact for any step, but a free body's orientation has an error of up to (w h)^3 / 12.
 */
void rb_top_step(const struct rb_top_body *body, double h, rb_quat *orientation, rb_vec3 *spin);

#endif
