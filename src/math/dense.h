/* SPDX-License-Identifier: MIT */
/* Small systems of linear equations, dense or nearly so, that may leave some unknowns open. */
#ifndef RB_MATH_DENSE_H
#define RB_MATH_DENSE_H

#include <stdbool.h>

/* All arrays are the caller's. */
struct rb_dense {
	double *matrix,
		*right; /* [n][n], [n]: used up; afterwards the solution stands in `right` */
	double *size, *noise, *found; /* [n] scratch; noise: of what is left of a column, in ulp */
	int *last, *down, *pivot, *from, *order; /* [n] scratch */
	/*
	 * [n], in, with `last` [n]: the first and last column of each row that may not be zero;
	 * others are not read. No row's first is after that of a row below it. NULL: all may be.
	 */
	const int *first;
	int n, late;   /* late: columns that were left for the end */
	long products; /* out: of rb_dense_solve, and its look at each entry that may not be zero */
	/* in: what is left of a column, as a share, is nothing up to here; 0: rounding */
	double least;
	bool open; /* out: the solution is one of many; unknowns that nothing determines are zero */
};

/*
 * Gaussian elimination with row pivots; of a column of which next to nothing is left it waits for
 * all others, since that may be another one's, by rounding. A column of which only rounding is
 * left, as a share of what it was, is open; what is then over-determined is left as it is. Zeros
 * are passed over, so that a band costs what its width is, and a look at each entry where its place
 * is not known.
 */
void rb_dense_solve(struct rb_dense *dense);

/*
 * For another right side, of the matrix that rb_dense_solve has just used up: what is open stays
 * open.
 */
void rb_dense_again(struct rb_dense *dense);

/*
 * After rb_dense_solve: what was left of each column when its turn came, as a share of its first
 * size, [n]; 0: it is open.
 */
void rb_dense_shares(const struct rb_dense *dense, double *share);

/* After rb_dense_solve: is unknown k one that nothing determines? */
bool rb_dense_is_open(const struct rb_dense *dense, int k);

/*
 * To the right: what leaves all right sides as they are, with one for that open unknown and zero
 * for the others. All of these are what solutions may differ by.
 */
void rb_dense_opened(struct rb_dense *dense, int k);

#endif
