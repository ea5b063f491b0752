/* SPDX-License-Identifier: MIT */
/*
 * Rows by iteration: sweeps of projected Gauss-Seidel, each row solved exactly on its own,
 * accelerated by Anderson mixing of the last ones (D. G. Anderson, J. ACM 12 (1965) 547), which
 * also copes with the coupling of friction and normals. FREE rows are solved in three directions at
 * once.
 *
 * For islands of few rows: their active set soon stays the same, and Anderson mixing then converges
 * very fast.
 */
#ifndef RB_STEPPED_GAUSS_SEIDEL_H
#define RB_STEPPED_GAUSS_SEIDEL_H

#include "base/arena.h"
#include "base/interrupt.h"
#include "constraint/row.h"

/* Weight of residual slip in a residual: it neither opens nor closes a gap. */
#define RB_SLIP_SHARE 0.3

/* Sweeps that Anderson mixing uses. */
enum { RB_SWEEP_MEMORY = 4 };
/* Approximate multiplications per row in a sweep. */
enum { RB_SWEEP_WORK = 256 };

struct rb_sweep_trace;

struct rb_sweep {
	const struct rb_row_system *dense;
	double tolerance; /* m/s: stops when no row's velocity changes by more */
	int max;          /* sweeps */
	bool central;     /* all rows are known to be central: contacts */
	/* [rows]: scratch, rb_sweep_take; inverse: of K of FREE rows, NULL: no such rows */
	struct rb_sweep_trace *trace;
	rb_mat3 *inverse;
	struct rb_interrupt *interrupt; /* borrowed; NULL: none */
};

struct rb_sweep_result {
	int sweeps;
	double residual; /* m/s: largest change of a row's velocity in the last sweep */
};

/* Applies the warm-start impulses of rows to the bodies. */
void rb_sweep_warm(const struct rb_row_system *dense);
struct rb_sweep_result rb_sweep_solve(const struct rb_sweep *sweep);
/*
 * Whether mixing has passed through impulses far larger than the final ones: velocities then have
 * the rounding error of the former. `impulses` [members] is scratch, `local` a body's index in it.
 */
bool rb_sweep_lost_digits(const struct rb_sweep *sweep, const int *local, double (*impulses)[2],
                          int member_count);

/* m/s: residual of a contact, as a sweep would find it. */
double rb_sweep_residual_of(const struct rb_row_system *rows, const struct rb_constraint *row);

/* Takes scratch, once `dense` is set; false: no memory. */
bool rb_sweep_take(struct rb_sweep *sweep, struct rb_arena *arena);

#endif
