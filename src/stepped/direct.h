/* SPDX-License-Identifier: MIT */
/*
 * Rows by Newton's method, for groups that are small, stiff, or of very unequal masses.
 *
 * Augmented Lagrangian: with the impulses of the outer iteration fixed, velocities minimize a
 * convex function that is quadratic on faces of the cones, by semi-smooth Newton steps with sparse
 * factors (stepped/blocks) and a line search; then impulses follow. Coulomb's law is De Saxce's
 * bipotential form: the cone's shift by friction times slip is taken from the outer iteration
 * before (Acary, Cadoux, Lemarechal, Malick, ZAMM 91 (2011) 155). Of other sets the projection is
 * the identity (FREE) or a clamp (INTERVAL), and the function its Moreau envelope all the same.
 * Redundant rows do no harm.
 */
#ifndef RB_STEPPED_DIRECT_H
#define RB_STEPPED_DIRECT_H

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

/* Units in the last place of impulses that rounding spoils: closer there is nothing to be had. */
enum { RB_DIRECT_NOISE_ULP = 16 };

struct rb_direct {
	const struct rb_row_system *dense;
	const struct rb_solver_body *free; /* by body: velocities without any impulse of the rows */
	const int *member;                 /* bodies that yield */
	int member_count;
	int *local;            /* by body: scratch, -1 for what does not yield */
	double tolerance;      /* m/s */
	double slip_tolerance; /* m/s: of the shift by sliding, which only ever opens gaps */
	/*
	 * m/s: of rows of joints, where it is larger. Redundant ones are in drift at odds with each
	 * other by its second order: to be closed farther than that costs impulses without end.
	 */
	double joint_tolerance;
	int steps_max; /* factorizations */
	/* after so many of them `acceptable`, m/s, will do for the tolerance; 0: never */
	int steps_few;
	double acceptable;
	bool holds; /* to begin with, as if nothing slipped: right where bodies stand */
	double max; /* multiplications that one factorization may take */
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
	struct rb_arena *arena;
};

struct rb_direct_result {
	bool tried;      /* false: too large, or no memory; nothing has changed */
	int steps;       /* factorizations */
	double residual; /* m/s */
};

/* Begins from the impulses that the rows have. */
struct rb_direct_result rb_direct_solve(const struct rb_direct *direct);

#endif
