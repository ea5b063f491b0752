/* SPDX-License-Identifier: MIT */
/*
 * If friction presses a slipping contact together more than its normal force separates it, the
 * force grows without bound before the slip ends (Painleve): an impact without an approach follows,
 * which ends with the slip (Genot, Brogliato, Eur. J. Mech. A 18 (1999) 653).
 */
#ifndef RB_LOCATED_PAINLEVE_H
#define RB_LOCATED_PAINLEVE_H

#include "located/pair_contacts.h"

/*
 * The contacts of bodies whose places are 0 .. body_count - 1 (l->place); all arrays are the
 * caller's.
 */
struct rb_painleve {
	struct rb_located *l;
	const struct rb_contact_point *contact_point;
	const rb_vec3 *force;   /* N, on b, present */
	const double *friction; /* coefficients */
	int count;
	const struct rb_pose *pose; /* [body_count] */
	int body_count;

	/* out */
	rb_vec3 *impulse;          /* [count]: N s, on b */
	rb_vec3 *linear, *angular; /* [body_count]: changes of velocities */
	rb_vec3 *scratch;          /* [3 count] */
};

/* Finds impulses that stop all contact points; false: they would pull, or be outside the cones. */
bool rb_painleve_stop(struct rb_painleve *painleve);
/*
 * The same along the forces, which balance each other where they have grown without bound, until
 * the first slip ends: for points that no impulses can stop together, and none of which jams alone.
 * False: no slip becomes slower.
 */
bool rb_painleve_slow(struct rb_painleve *painleve);

/*
 * Returns the points of a pair, [count], as a single point at the centre of their normal forces, at
 * least one of which is positive.
 */
struct rb_contact_point rb_painleve_middle(const struct rb_located *l,
                                           const struct rb_contact_point *points,
                                           const rb_vec3 *force, int count);

/*
 * Returns the impulse on b, N s, by the law of constraint/eccentric with an approach of rounding
 * size, since the normal velocity is rounding; `change`: of the relative velocity, m/s. Zero if the
 * contact has a solution: the impulse is then of that size.
 */
rb_vec3 rb_painleve_impulse(const struct rb_located *l, const struct rb_contact_point *m,
                            rb_vec3 *change);

/*
 * For points of a pair, [count], that together have a solution: returns the one with the largest
 * normal force of those that have none alone. It is stopped, and others take part if that makes
 * them approach. -1: there are none.
 */
int rb_painleve_alone(const struct rb_located *l, const struct rb_contact_point *points,
                      const rb_vec3 *force, int count);

#endif
