/* SPDX-License-Identifier: MIT */
/*
 * The solution of the complementarity problem of constraint/cone.
 *
 * Steps of all rows at once (projected, with momentum) find out which contacts close, stick and
 * slip; Newton steps on those faces, with conjugate residuals inside, are exact once the faces are.
 * Where all friction bounds are given the problem is convex and the energy decides what is
 * progress, so that it always comes to an end; with Coulomb's bounds the residual decides, and
 * bounds held fixed for a while help where it gets stuck.
 */
#ifndef RB_CONSTRAINT_COULOMB_H
#define RB_CONSTRAINT_COULOMB_H

#include "constraint/cone.h"

/*
 * From the rows' impulses as they are (a guess, or zero), which the bodies have had. Returns what
 * is left of the largest violation, in the unit of u. `scale`: the largest speed that u is a
 * difference of. Where no solution with the whole friction is found, cone->gave_way is set: then
 * what slips may have less of it than the law says, but nothing approaches and the cones are kept.
 */
double rb_cone_resolve(struct rb_cone *cone, double scale);

#endif
