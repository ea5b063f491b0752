/* SPDX-License-Identifier: MIT */
/*
 * Rows by Newton's method, for islands that are small, stiff, or of very unequal masses.
 *
 * Augmented Lagrangian: with the multipliers of the outer iteration fixed, velocities minimize a
 * convex, piecewise quadratic function by semi-smooth Newton steps with sparse factors
 * (stepped/blocks) and a line search; then the multipliers are updated. Coulomb's law is in De
 * Saxce's bipotential form: the cone's shift, friction times slip, is taken from the previous outer
 * iteration (Acary, Cadoux, Lemarechal, Malick, ZAMM 91 (2011) 155). For other sets the projection
 * is the identity (FREE) or a clamp (INTERVAL), and the function is likewise its Moreau envelope.
 * Redundant rows do no harm.
 */
#ifndef RB_STEPPED_DIRECT_H
#define RB_STEPPED_DIRECT_H

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

/* Rounding error of impulses, in ulp: no residual can be smaller. */
enum { RB_DIRECT_NOISE_ULP = 16 };

struct rb_direct {
	const struct rb_row_system *dense;
	const struct rb_solver_body *free; /* by body: velocities without any impulse of the rows */
	const int *member;                 /* dynamic bodies */
	int member_count;
	int *local;            /* by body: scratch, -1 if not dynamic */
	double tolerance;      /* m/s */
	double slip_tolerance; /* m/s: of the cones' shifts, whose errors only ever open gaps */
	/*
	 * m/s: of rows of joints, if larger. Redundant ones contradict each other by second-order
	 * terms of their drift: a smaller residual would cost impulses without bound.
	 */
	double joint_tolerance;
	int steps_max; /* factorizations */
	/* after so many of them a residual of `acceptable`, m/s, suffices; 0: never */
	int steps_few;
	double acceptable;
	bool holds; /* starts as if nothing slipped: correct for islands at rest */
	double max; /* multiplications that one factorization may take */
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
	struct rb_arena *arena;
};

struct rb_direct_result {
	bool tried;      /* false: too large, or no memory; nothing has changed */
	int steps;       /* factorizations */
	double residual; /* m/s */
};

/* Starts from the impulses of the rows. */
struct rb_direct_result rb_direct_solve(const struct rb_direct *direct);

#endif
