/* SPDX-License-Identifier: MIT */
/*
 * Geometric stiffness of joint forces for a body's rotation: a force F at a point r continues to
 * act where the rotation t has moved the point, with a torque of -(F.r) t across r. At the end of
 * the step that is equivalent to an inertia of h^2 F.r, where the step does not resolve it: light
 * links that carry heavy bodies (Tournier, Nesme, Gilles, Faure, ACM TOG 34(4):132 (2015)).
 *
 * Reads the world as the step begins; any thread, one body each.
 */
#ifndef RB_STEPPED_GEOMETRIC_STIFFNESS_H
#define RB_STEPPED_GEOMETRIC_STIFFNESS_H

#include "stepped/joint_constraints.h"

/*
 * Adds it to the inertia of the body, which keeps its angular momentum, if it exceeds the fraction
 * of it that steps resolve: true, and the inverse is in `tensor`.
 */
bool rb_geometric_stiffness_add(const struct rb_world *world, const struct rb_step_joint *joints,
                                int i, double h_s, struct rb_solver_body *body, rb_mat3 *tensor);

#endif
