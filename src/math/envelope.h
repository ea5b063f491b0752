/* SPDX-License-Identifier: MIT */
/*
 * Symmetric positive definite systems of which rows reach back only so far, as L D L^T: nothing is
 * filled in outside the rows' own reach (A. Jennings, Comput. J. 9 (1966) 281), so that a band
 * costs the square of its width for each row, and no more than that is stored.
 *
 * Up to RB_ENVELOPE_BLOCK rows that follow each other are a block: they reach back equally far, and
 * stand column by column, so that all of them take the same step at a time. An odd one is followed
 * by a row of zeros.
 */
#ifndef RB_MATH_ENVELOPE_H
#define RB_MATH_ENVELOPE_H

#include <stdbool.h>
#include <stddef.h>

enum { RB_ENVELOPE_BLOCK = 6 };

/* Where the rows of a block are. */
struct rb_envelope_block {
	int begin, count; /* of rows, 1 to RB_ENVELOPE_BLOCK */
	int pitch;        /* of columns: count, or one more */
	int first;        /* column that they reach back to, <= begin */
	size_t at;        /* of entry (begin, first) in `value` */
};

/* All arrays are the caller's. */
struct rb_envelope {
	int n, block_count;
	struct rb_envelope_block *block; /* [block_count]: one after the other, n rows in all */
	int *of;                         /* [n]: block of each row */
	double *value; /* [rb_envelope_lay_out]: entries of the lower half; after it, L */
	double *pivot; /* [n]: D */
};

/* `value` is no larger: so large with single rows, which take two each, that reach to 0. */
static inline size_t rb_envelope_size_max(int n)
{
	return ((size_t)n + 4) * (size_t)n;
}

/*
 * Fills `pitch`, `at` and `of` from the blocks' rows and first columns; returns the size of
 * `value`.
 */
size_t rb_envelope_lay_out(struct rb_envelope *e);

/* Row r from its first column on, of which entries are `stride` apart. */
static inline double *rb_envelope_row(const struct rb_envelope *e, int r, size_t *stride)
{
	const struct rb_envelope_block *const b = &e->block[e->of[r]];

	*stride = (size_t)b->pitch;
	return e->value + b->at + (size_t)(r - b->begin);
}

/*
 * In place; entries outside the lower half are zero. False where what is left of a
 * diagonal entry is no more than the share `least` of it (or not a number): the system may be
 * singular, and the entries are used up.
 */
bool rb_envelope_factor(struct rb_envelope *e, double least);

/* x [n]: right side in, solution out; after rb_envelope_factor. */
void rb_envelope_solve(const struct rb_envelope *e, double *x);

#endif
