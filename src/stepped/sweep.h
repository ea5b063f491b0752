/* SPDX-License-Identifier: MIT */
/*
 * Rows by iteration: sweeps of projected Gauss-Seidel, each row set right on its own, accelerated as nonlinear conjugate
 * gradients (Silcowitz, Niebe, Erleben, Vis. Comput. 26 (2010) 893) with a plain sweep after each.
 *
 * Rows that follow each other in one colour share no body that yields, so a colour's blocks may run at the same time; what
 * comes out depends on the blocks, never on the workers.
 */
#ifndef RB_STEPPED_SWEEP_H
#define RB_STEPPED_SWEEP_H

#include "base/arena.h"
#include "base/team.h"
#include "stepped/row.h"

struct rb_sweep {
	const struct rb_dense *dense;
	double enough;        /* m/s: stops when no row's velocity changes by more */
	int most;             /* sweeps */
	struct rb_team *team; /* NULL: in one thread, in order of rows, without colours */
	const int *colour;    /* [colour_count + 1]: first row of each */
	int colour_count;
	bool tail;       /* rows of the last colour share bodies after all: one after the other */
	double *partial; /* [2 x blocks of all colours]: scratch; NULL without team */
};

struct rb_sweep_result {
	int sweeps;
	double residual; /* m/s: largest change of a row's velocity in the last sweep */
};

enum { RB_SWEEP_BLOCK = 512 };

/* Applies the impulses that rows begin with to the bodies. */
void rb_sweep_warm(const struct rb_dense *dense);
struct rb_sweep_result rb_sweep_solve(const struct rb_sweep *sweep);

/* Blocks of all colours. */
int rb_sweep_blocks(const int *colour, int colour_count);

#endif
