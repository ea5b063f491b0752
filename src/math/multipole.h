/* SPDX-License-Identifier: MIT */
/*
 * Attraction between groups of points by their moments. With g(r) = (r^2 + s^2)^(-1/2), points b
 * of a group about the centre z_B, and points a of another about z_A,
 *
 *     psi(a) = sum_b mu_b g(a - b) = sum_n (a - z_A)^n/n! F_n,
 *     F_n = sum_m Q_m D_(n+m)(z_A - z_B),
 *     Q_m = sum_b mu_b (z_B - b)^m/m!,                           D_k = d^k g,
 *
 * n and m being triples of exponents with |n| + |m| <= RB_MULTIPOLE_ORDER. Cut off by the *sum* of
 * both orders, the potential of a pair of points still depends on their difference alone: what two
 * groups give each other is opposite, to rounding (W. Dehnen, ApJ 536 (2000) L39; J. Comput. Phys.
 * 179 (2002) 27). Centres are those of mu, so that Q has no dipole.
 *
 * Triples are listed by order k, then by j = b + c, then by c, for x^a y^b z^c. Only operations
 * that IEEE 754 rounds exactly, in a fixed order: the same bits on every machine.
 */
#ifndef RB_MATH_MULTIPOLE_H
#define RB_MATH_MULTIPOLE_H

#include "math/lanes.h"
#include "math/vec3.h"

enum {
	RB_MULTIPOLE_ORDER = 6,
	RB_MULTIPOLE_TERMS = (RB_MULTIPOLE_ORDER + 1) * (RB_MULTIPOLE_ORDER + 2) *
	                     (RB_MULTIPOLE_ORDER + 3) / 6
};

/* Adds a point at z_B - `d` to its group's moments. */
void rb_multipole_add(double moment[RB_MULTIPOLE_TERMS], double mu, rb_vec3 d);
/* Adds a group's moments to those about a centre that is `d` from its own. */
void rb_multipole_lift(double moment[RB_MULTIPOLE_TERMS], const double part[RB_MULTIPOLE_TERMS],
                       rb_vec3 d);
/* Adds a group's field F to that of a part of it, the centre of which is `d` from its own. */
void rb_multipole_lower(double field[RB_MULTIPOLE_TERMS], const double whole[RB_MULTIPOLE_TERMS],
                        rb_vec3 d);
/* Acceleration, grad psi, at `d` from the centre; `*potential`: psi there. */
rb_vec3 rb_multipole_at(const double field[RB_MULTIPOLE_TERMS], rb_vec3 d, double *potential);

/* Groups that act: centres and moments. */
struct rb_multipole_sources {
	const double (*center)[3];
	const double (*moment)[RB_MULTIPOLE_TERMS];
};

/*
 * The field about `center` of those sources that `list` names, added to `field`; `soft2` is s^2.
 * Four at a time, in the order of the list.
 */
void rb_multipole_field(const struct rb_multipole_sources *sources, const int *list, int count,
                        double soft2, const double center[3], double field[RB_MULTIPOLE_TERMS]);

#endif
