/* SPDX-License-Identifier: MIT */
/*
 * Rows of joints alone, without contacts, by how they answer each other: with K_ij what an impulse
 * on row j changes the velocity of row i by, K p = w - u, in blocks of six rows of one pair of
 * bodies, by sparse factors (stepped/blocks): a chain costs a multiple of its length, whatever its
 * masses.
 *
 * Rows that are at a bound are left out; which ones are is found by pivoting. Targets of rows that
 * depend on each other are changed to the nearest ones that do not contradict each other: what is
 * of second order in drift would else grow into forces of joints against each other. Rows that
 * depend on others evidently get no impulse, and hold as the others do. So do limits and ropes
 * while they hold. Motors and friction depend on nothing: several on one coordinate are told apart
 * by their bounds.
 */
#ifndef RB_STEPPED_DUAL_H
#define RB_STEPPED_DUAL_H

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

struct rb_dual {
	const struct rb_row_system
		*dense;                 /* impulses to begin with are in the bodies' velocities */
	double tolerance;               /* m/s: close enough */
	double max;                     /* multiplications that one factorization may take */
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
	struct rb_arena *arena;
};

struct rb_dual_result {
	bool tried;      /* false: too large, or no memory; nothing has changed */
	int steps;       /* factorizations */
	double residual; /* m/s */
};

/* No CONE among the rows. */
struct rb_dual_result rb_dual_solve(const struct rb_dual *dual);

#endif
