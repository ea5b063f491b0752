/* SPDX-License-Identifier: MIT */
/*
 * Rows by iteration: sweeps of projected Gauss-Seidel, each row set right on its own, accelerated by Anderson's mixture
 * of the last ones (D. G. Anderson, J. ACM 12 (1965) 547), which also copes with how friction and normals meddle.
 *
 * Rows that follow each other in one colour share no body that yields, so a colour's blocks may run at the same time; what
 * comes out depends on the blocks, never on the workers.
 */
#ifndef RB_STEPPED_SWEEP_H
#define RB_STEPPED_SWEEP_H

#include "base/arena.h"
#include "base/team.h"
#include "stepped/row.h"

/* Rows of a block; sweeps that the mixture knows; numbers that a block leaves. */
enum { RB_SWEEP_BLOCK = 512, RB_SWEEP_MEMORY = 4, RB_SWEEP_PARTIAL = 2 * RB_SWEEP_MEMORY };

struct rb_sweep_trace;

struct rb_sweep {
	const struct rb_dense *dense;
	double enough;        /* m/s: stops when no row's velocity changes by more */
	int most;             /* sweeps */
	struct rb_team *team; /* NULL: in one thread, in order of rows, without colours */
	const int *colour;    /* [colour_count + 1]: first row of each */
	int colour_count;
	bool tail; /* rows of the last colour share bodies after all: one after the other */
	/* scratch, rb_sweep_take */
	double *partial;              /* [RB_SWEEP_PARTIAL x blocks] */
	struct rb_sweep_trace *trace; /* [rows] */
};

struct rb_sweep_result {
	int sweeps;
	double residual; /* m/s: largest change of a row's velocity in the last sweep */
};

/* Applies the impulses that rows begin with to the bodies. */
void rb_sweep_warm(const struct rb_dense *dense);
struct rb_sweep_result rb_sweep_solve(const struct rb_sweep *sweep);

/* Scratch, once dense, team and colours are known; false: no memory. */
bool rb_sweep_take(struct rb_sweep *sweep, struct rb_arena *arena);

#endif
