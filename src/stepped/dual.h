/* SPDX-License-Identifier: MIT */
/*
 * Rows of joints alone, without contacts, by their Delassus matrix: with K_ij the velocity change
 * of row i per impulse on row j, K p = w - u, in blocks of up to six rows of one pair of bodies, by
 * sparse factors (stepped/blocks): a chain costs in proportion to its length, whatever its masses.
 *
 * Rows at a bound are left out; which ones are is found by pivoting. Targets of rows that depend on
 * each other are replaced by the nearest consistent ones: second-order terms of drift would
 * otherwise grow into self-stress of redundant joints. Rows that clearly depend on others get no
 * impulse, and are satisfied if the others are. So do limits and ropes while they are active.
 * Motors and friction are never dependent: several on one coordinate are distinguished by their
 * bounds.
 */
#ifndef RB_STEPPED_DUAL_H
#define RB_STEPPED_DUAL_H

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

struct rb_dual {
	const struct rb_row_system
		/* initial impulses are included in the bodies' velocities */
		*dense;
	double tolerance;               /* m/s */
	double max;                     /* multiplications that one factorization may take */
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
	struct rb_arena *arena;
};

struct rb_dual_result {
	bool tried;      /* false: too large, or no memory; nothing has changed */
	int steps;       /* factorizations */
	double residual; /* m/s */
};

/* Rows must not contain a CONE. */
struct rb_dual_result rb_dual_solve(const struct rb_dual *dual);

#endif
