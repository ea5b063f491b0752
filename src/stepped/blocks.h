/* SPDX-License-Identifier: MIT */
/*
 * Sparse symmetric positive definite systems of 6x6 blocks, one block row per body, by Cholesky
 * factors in a minimum-degree order. Memory comes from the caller's arena and lives as long as its
 * mark.
 */
#ifndef RB_STEPPED_BLOCKS_H
#define RB_STEPPED_BLOCKS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/arena.h"

enum { RB_BLOCK = 6 };
typedef struct {
	double m[RB_BLOCK][RB_BLOCK];
} rb_block;

struct rb_blocks {
	int count;  /* number of block rows */
	int *place; /* [count]: a body's index in the order of elimination */
	int *first; /* [count + 1]: start of each column in `row` and `value` */
	/* block rows of a column, in the order of elimination, ascending, the diagonal first */
	int *row;
	rb_block *value;
	double work; /* multiplications of one factorization */
	/*
	 * [count][6] in the order of elimination, owned by the caller; NULL: none. Least pivots: an
	 * unknown with a smaller one depends on others; it becomes zero in solutions, and INFINITY
	 * here.
	 */
	double *pivot_min;
	double scale; /* of the factored matrix relative to the system */
};

/*
 * Finds the order of elimination and the blocks of the factors, for `pair_count` pairs of bodies
 * that share a block. False: no memory, or a factorization would take more than `max`
 * multiplications.
 */
bool rb_blocks_plan(struct rb_blocks *blocks, int count, const int (*pair)[2], int pair_count,
                    double max, struct rb_arena *arena);

void rb_blocks_clear(struct rb_blocks *blocks);
/* The block of two bodies; `*transposed`: it is stored transposed. */
rb_block *rb_blocks_at(struct rb_blocks *blocks, int a, int b, bool *transposed);
/* Factors in place; false if not positive definite. */
bool rb_blocks_factor(struct rb_blocks *blocks);
/* x is [count][6] by body: right-hand side in, solution out; scratch is as large. */
void rb_blocks_solve(const struct rb_blocks *blocks, double *x, double *scratch);

#endif
