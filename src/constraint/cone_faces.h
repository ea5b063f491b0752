/* SPDX-License-Identifier: MIT */
/*
 * The linear part of a Newton step of constraint/coulomb: rows stand on known faces of their cones,
 * and what changes of the impulses keep them there. By conjugate residuals; what joints hold is
 * eliminated. Scratch is the cone's.
 */
#ifndef RB_CONSTRAINT_CONE_FACES_H
#define RB_CONSTRAINT_CONE_FACES_H

#include "constraint/cone.h"

/*
 * Solves the linearized problem on the present faces for `x`, given the steps in cone->residual
 * (used up). What joints hold is eliminated where residuals do not end without that soon: an
 * elimination has an order, and its rounding with it. False: they did not end.
 */
bool rb_cone_faces_solve(struct rb_cone *cone, rb_along_across *x);

#endif
