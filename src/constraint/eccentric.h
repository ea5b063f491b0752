/* SPDX-License-Identifier: MIT */
/*
 * The impulse of an eccentric impact with friction: Keller's equations (J. Appl. Mech. 53 (1986) 1)
 * with Stronge's energetic restitution (Proc. R. Soc. A 431 (1990) 169).
 *
 * While the normal impulse p grows the relative velocity follows du/dp = K (n - mu s), s the
 * direction of slip. Slip that comes to its end within the impact sticks from there on, if the cone
 * allows that, or sets in anew in the one direction in which it then grows. Compression ends where
 * the normal velocity is zero; the impact ends when the normal force has given back e^2 of the work
 * that compression took. Where friction draws the bodies together again before that, compression
 * goes on, and its work counts as well. An impact without an approach (Painleve: slip along which
 * friction presses harder together than the contact yields) is the same process from a normal
 * velocity of zero.
 *
 * Exact to the rounding of what goes in, and finite for whatever is finite; kinetic energy never
 * grows.
 */
#ifndef RB_CONSTRAINT_ECCENTRIC_H
#define RB_CONSTRAINT_ECCENTRIC_H

#include "math/mat3.h"

struct rb_eccentric {
	rb_mat3 inverse_effective_mass; /* 1/kg: K, symmetric and positive */
	rb_vec3 normal;                 /* unit, from a to b */
	double friction, restitution;
};

/*
 * On b, N s, at relative velocity `velocity` (of b to a, m/s): zero where they neither approach nor
 * jam.
 */
rb_vec3 rb_eccentric_impulse(const struct rb_eccentric *contact, rb_vec3 velocity);

#endif
