/* SPDX-License-Identifier: MIT */
/*
 * Sparse symmetric positive definite systems of 6x6 blocks, one row of blocks a body, by Cholesky's
 * factors in an order of least degree. Memory comes from the caller's arena and lives as long as
 * its mark.
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
	int count;  /* of rows of blocks */
	int *place; /* [count]: where a body stands in the order of elimination */
	int *first; /* [count + 1]: of each column in `row` and `value` */
	int *row;   /* places of the blocks of a column, ascending, the diagonal first */
	rb_block *value;
	double work; /* multiplications that one factorization takes */
	/*
	 * [count][6] in the order of elimination, the caller's; NULL: none. An unknown with a pivot
	 * of no more depends on others: it comes out as zero, and as INFINITY here.
	 */
	double *least;
	double scale; /* of the factors, over the system */
};

/*
 * The order and the places of blocks for `pair_count` pairs of bodies that share a block. False: no
 * memory, or it would take more than `most` multiplications a factorization.
 */
bool rb_blocks_plan(struct rb_blocks *blocks, int count, const int (*pair)[2], int pair_count,
                    double max, struct rb_arena *arena);

void rb_blocks_clear(struct rb_blocks *blocks);
/* The block of two bodies; `*turned`: it is kept transposed. */
rb_block *rb_blocks_at(struct rb_blocks *blocks, int a, int b, bool *turned);
/* In place; false where it is not positive. */
bool rb_blocks_factor(struct rb_blocks *blocks);
/* x is [count][6] by body: right side in, solution out; scratch is as large. */
void rb_blocks_solve(const struct rb_blocks *blocks, double *x, double *scratch);

#endif
