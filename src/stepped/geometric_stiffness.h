/* SPDX-License-Identifier: MIT */
/*
 * What the pull of a body's joints does to its turning in the step: a point at r that is pulled by
 * F goes on being pulled by it where turning by t has brought it, with a torque of -(F.r) t across
 * r. At the end of the step that is h^2 F.r of inertia, where the step does not resolve it: light
 * links that carry heavy bodies (Tournier, Nesme, Gilles, Faure, ACM TOG 34(4):132 (2015)).
 *
 * Reads the world as the step begins; any thread, one body each.
 */
#ifndef RB_STEPPED_GEOMETRIC_STIFFNESS_H
#define RB_STEPPED_GEOMETRIC_STIFFNESS_H

#include "stepped/joint_constraints.h"

/*
 * Adds that to the inertia of the body, which keeps its angular momentum, if it is a larger share
 * of it than steps resolve: true, and the inverse is in `tensor`.
 */
bool rb_geometric_stiffness_add(const struct rb_world *world, const struct rb_step_joint *joints,
                                int i, double h_s, struct rb_solver_body *body, rb_mat3 *tensor);

#endif
