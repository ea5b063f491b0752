/* SPDX-License-Identifier: MIT */
/*
 * The linear system of a Newton step of constraint/coulomb: the changes of the impulses while rows
 * stay on known faces of their cones. Solved by conjugate residuals; joints are eliminated. Scratch
 * is the cone's.
 */
#ifndef RB_CONSTRAINT_CONE_FACES_H
#define RB_CONSTRAINT_CONE_FACES_H

#include "constraint/cone.h"

/*
 * Solves the linearized problem on the present faces for `x`, given the steps in cone->residual
 * (overwritten). Joints are eliminated only if the residuals do not converge soon without that: an
 * elimination depends on order by rounding. False: they did not converge.
 */
bool rb_cone_faces_solve(struct rb_cone *cone, rb_along_across *x);

#endif
