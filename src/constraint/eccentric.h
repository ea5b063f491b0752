/* SPDX-License-Identifier: MIT */
/*
 * The impulse of an eccentric impact with friction: Keller's equations (J. Appl. Mech. 53 (1986) 1)
 * with Stronge's energetic restitution (Proc. R. Soc. A 431 (1990) 169).
 *
 * While the normal impulse p grows, the relative velocity follows du/dp = K (n - mu s), with s the
 * direction of slip. If slip ends within the impact, the contact sticks from then on, if the cone
 * allows that, or slips again in the only direction in which slip then grows. Compression ends at
 * zero normal velocity; the impact ends when the normal force has returned e^2 of the work of
 * compression. If friction makes the bodies approach again before that, compression continues, and
 * its work counts as well. An impact without an approach (Painleve: a slip whose friction presses
 * the bodies together more than the normal impulse separates them) is the same process from a
 * normal velocity of zero.
 *
 * Exact to the rounding of the input, and finite for finite input; kinetic energy never grows.
 */
#ifndef RB_CONSTRAINT_ECCENTRIC_H
#define RB_CONSTRAINT_ECCENTRIC_H

#include "math/mat3.h"

struct rb_eccentric {
	rb_mat3 inverse_effective_mass; /* 1/kg: K, symmetric and positive, or see `error` */
	rb_vec3 normal;                 /* unit, from a to b */
	double friction, restitution;
	/*
	 * relative error of K: of a linkage, which may be singular within it (a contact that sticks
	 * and cannot separate then keeps what restitution would give back); 0: K is positive
	 */
	double error;
};

/*
 * Returns the impulse on b, N s, at the relative velocity of b to a, m/s; zero if they neither
 * approach nor jam.
 */
rb_vec3 rb_eccentric_impulse(const struct rb_eccentric *contact, rb_vec3 velocity);

#endif
