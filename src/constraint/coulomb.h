/* SPDX-License-Identifier: MIT */
/*
 * Solver of the complementarity problem of constraint/cone.
 *
 * Simultaneous steps of all rows (projected, with momentum) find the active set: which contacts
 * close, stick and slip. Newton steps on these faces, by conjugate residuals, are exact once the
 * faces are right. With fixed friction bounds the problem is convex and progress is measured by
 * energy, so that it always terminates; with Coulomb's bounds it is measured by the residual, and
 * bounds that are held fixed for a while help where it stalls.
 */
#ifndef RB_CONSTRAINT_COULOMB_H
#define RB_CONSTRAINT_COULOMB_H

#include "constraint/cone.h"

/*
 * Starts from the rows' impulses (a guess, or zero), which must have been applied to the bodies.
 * Returns the largest remaining violation, in the unit of u. `scale`: the largest speed that u is a
 * difference of. If no solution with the whole friction is found, sets cone->friction_reduced: then
 * slipping rows may have less friction than the law says, but nothing approaches and impulses are
 * within their cones.
 */
double rb_cone_resolve(struct rb_cone *cone, double scale);

/*
 * After a failed rb_cone_resolve without friction: do its impulses prove that no velocities of less
 * than 1e8 times the energy at hand end the approaches? `before`: u without the impulses.
 * False: they prove nothing.
 */
bool rb_cone_is_blocked(struct rb_cone *cone, const rb_along_across *before, double scale);

#endif
