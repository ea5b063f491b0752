/* SPDX-License-Identifier: MIT */
/*
 * Where friction presses a slipping contact harder together than it yields, its force grows beyond
 * all bounds before the slip ends (Painleve): what follows is an impact without an approach, which
 * ends with the slip (Genot, Brogliato, Eur. J. Mech. A 18 (1999) 653).
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
	const rb_vec3 *force;   /* N, on b, as they have grown */
	const double *friction; /* coefficients */
	int count;
	const struct rb_pose *pose; /* [body_count] */
	int body_count;

	/* out */
	rb_vec3 *impulse;          /* [count]: N s, on b */
	rb_vec3 *linear, *angular; /* [body_count]: what they add to velocities */
	rb_vec3 *scratch;          /* [3 count] */
};

/* Impulses that stop all contacts' points; false: they would pull, or be outside the cones. */
bool rb_painleve_stop(struct rb_painleve *painleve);
/*
 * The same along the forces, which balance each other where they have grown without bound, as far
 * as the first of the slips ends: of points of which no impulse stops all, and none jams alone.
 * False: none becomes slower.
 */
bool rb_painleve_slow(struct rb_painleve *painleve);

/* The points of a pair, [count], as one: at the centre of their normal forces; one pushes. */
struct rb_contact_point rb_painleve_middle(const struct rb_located *l,
                                           const struct rb_contact_point *points,
                                           const rb_vec3 *force, int count);

/*
 * Impulse, on b, N s, by the law of constraint/eccentric for an approach of rounding size, since
 * the normal velocity is rounding; `change`: of the relative velocity, m/s. Zero where the contact
 * has a solution after all: the impulse is then of that size.
 */
rb_vec3 rb_painleve_impulse(const struct rb_located *l, const struct rb_contact_point *m,
                            rb_vec3 *change);

/*
 * Of points of a pair, [count], that have a force as one: the one that presses most of those that
 * have none on their own. It is stopped, and others take part if that makes them approach. -1:
 * there are none.
 */
int rb_painleve_alone(const struct rb_located *l, const struct rb_contact_point *points,
                      const rb_vec3 *force, int count);

#endif
