/* SPDX-License-Identifier: MIT */
/*
 * Symmetric positive definite systems with a profile (envelope), factored as L D L^T: there is no
 * fill-in before the first column of a row (A. Jennings, Comput. J. 9 (1966) 281), so that a band
 * costs the square of its width per row, and only the profile is stored.
 *
 * Up to RB_ENVELOPE_BLOCK consecutive rows form a block: they have the same first column and are
 * stored column by column, for vector instructions. An odd number of rows is padded by a row of
 * zeros.
 */
#ifndef RB_MATH_ENVELOPE_H
#define RB_MATH_ENVELOPE_H

#include <stdbool.h>
#include <stddef.h>

enum { RB_ENVELOPE_BLOCK = 6 };

/* Position of a block of rows. */
struct rb_envelope_block {
	int begin, count; /* of rows, 1 to RB_ENVELOPE_BLOCK */
	int pitch;        /* entries per column: count, or one more */
	int first;        /* first column of its rows, <= begin */
	size_t at;        /* index of entry (begin, first) in `value` */
};

/* All arrays are the caller's. */
struct rb_envelope {
	int n, block_count;
	struct rb_envelope_block *block; /* [block_count]: one after the other, n rows in all */
	int *of;                         /* [n]: block of each row */
	double *value; /* [rb_envelope_lay_out]: entries of the lower half; after it, L */
	double *pivot; /* [n]: D */
};

/*
 * Upper bound of the size of `value`: reached by single rows, which take two each, that begin at
 * column 0.
 */
static inline size_t rb_envelope_size_max(int n)
{
	return ((size_t)n + 4) * (size_t)n;
}

/*
 * Fills `pitch`, `at` and `of` from the blocks' rows and first columns; returns the size of
 * `value`.
 */
size_t rb_envelope_lay_out(struct rb_envelope *e);

/* Returns row r from its first column on; its entries are `stride` apart. */
static inline double *rb_envelope_row(const struct rb_envelope *e, int r, size_t *stride)
{
	const struct rb_envelope_block *const b = &e->block[e->of[r]];

	*stride = (size_t)b->pitch;
	return e->value + b->at + (size_t)(r - b->begin);
}

/*
 * Factors in place; entries outside the lower half are zero. False if the rest of a diagonal entry
 * is at most the share `least` of it (or NaN): the system may be singular, and the entries are
 * overwritten.
 */
bool rb_envelope_factor(struct rb_envelope *e, double least);

/* x [n]: right side in, solution out; after rb_envelope_factor. */
void rb_envelope_solve(const struct rb_envelope *e, double *x);

#endif
