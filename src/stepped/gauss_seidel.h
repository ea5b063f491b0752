/* SPDX-License-Identifier: MIT */
/*
 * Rows by iteration: sweeps of projected Gauss-Seidel, each row set right on its own, accelerated
 * by Anderson's mixture of the last ones (D. G. Anderson, J. ACM 12 (1965) 547), which also copes
 * with how friction and normals meddle. FREE rows are set right in three directions at once.
 *
 * For groups of few rows: these settle soon which of them act, and a mixture then comes close very
 * fast.
 */
#ifndef RB_STEPPED_GAUSS_SEIDEL_H
#define RB_STEPPED_GAUSS_SEIDEL_H

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

/* Slip that is left opens no gap and closes none: of a residual it counts by this share. */
#define RB_SLIP_SHARE 0.3

/* Sweeps that the mixture knows. */
enum { RB_SWEEP_MEMORY = 4 };
/* Multiplications of a row in a sweep, about. */
enum { RB_SWEEP_WORK = 256 };

struct rb_sweep_trace;

struct rb_sweep {
	const struct rb_row_system *dense;
	double tolerance; /* m/s: stops when no row's velocity changes by more */
	int max;          /* sweeps */
	bool central;     /* all rows are known to be central: contacts */
	/* [rows]: scratch, rb_sweep_take; inverse: of K of FREE rows, NULL: there are none */
	struct rb_sweep_trace *trace;
	rb_mat3 *inverse;
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
};

struct rb_sweep_result {
	int sweeps;
	double residual; /* m/s: largest change of a row's velocity in the last sweep */
};

/* Applies the impulses that rows begin with to the bodies. */
void rb_sweep_warm(const struct rb_row_system *dense);
struct rb_sweep_result rb_sweep_solve(const struct rb_sweep *sweep);
/*
 * Whether mixtures have led to impulses far beyond what it came to: velocities have the rounding of
 * these. `impulses` [members] is scratch, `local` a body's place in it.
 */
bool rb_sweep_went_far(const struct rb_sweep *sweep, const int *local, double (*impulses)[2],
                       int member_count);

/* m/s: what a contact is off by, as a sweep would find it. */
double rb_sweep_off_by(const struct rb_row_system *rows, const struct rb_constraint *row);

/* Scratch, once dense is known; false: no memory. */
bool rb_sweep_take(struct rb_sweep *sweep, struct rb_arena *arena);

#endif
