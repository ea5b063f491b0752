/* SPDX-License-Identifier: MIT */
/*
 * Small systems of linear equations, dense or nearly so, possibly rank-deficient: unknowns that are
 * not determined are open.
 */
#ifndef RB_MATH_DENSE_H
#define RB_MATH_DENSE_H

#include <stdbool.h>

/* All arrays are the caller's. */
struct rb_dense {
	double *matrix, *right; /* [n][n], [n]: overwritten, `right` by the solution */
	double *size, *noise,
		*found; /* [n] scratch; noise: rounding of the rest of a column, in ulp */
	int *last, *down, *pivot, *from, *order; /* [n] scratch */
	/*
	 * [n], in, with `last` [n]: first and last column of each row that may not be zero; others
	 * are not read. first does not decrease from row to row. NULL: all may be non-zero.
	 */
	const int *first;
	int n, late;   /* late: columns postponed to the end */
	long products; /* out: of rb_dense_solve, plus one per entry that may not be zero */
	/* in: share of a column that counts as zero; 0: rounding */
	double least;
	bool open; /* out: the solution is not unique; undetermined unknowns are zero */
};

/*
 * Gaussian elimination with row pivots; a column with a small rest waits for all others, because it
 * may depend on another one, to rounding. A column whose rest is only rounding, relative to its
 * first size, is open; over-determined equations are left unsatisfied. Zeros are skipped, so that a
 * band costs according to its width, plus a check of each entry if the zero structure is not given.
 */
void rb_dense_solve(struct rb_dense *dense);

/*
 * Solves for another right side with the matrix that rb_dense_solve has just factored; open
 * unknowns remain open.
 */
void rb_dense_again(struct rb_dense *dense);

/*
 * After rb_dense_solve: rest of each column when it was eliminated, relative to its first size,
 * [n]; 0: it is open.
 */
void rb_dense_shares(const struct rb_dense *dense, double *share);

/* After rb_dense_solve: is unknown k undetermined? */
bool rb_dense_is_open(const struct rb_dense *dense, int k);

/*
 * Computes, in `right`, the kernel vector with one for that open unknown and zero for the others.
 * These span the differences between solutions.
 */
void rb_dense_opened(struct rb_dense *dense, int k);

#endif
