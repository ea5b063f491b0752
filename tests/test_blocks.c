/* SPDX-License-Identifier: MIT */
/* src/stepped/blocks.c: sparse systems of 6x6 blocks */
#include "support.h"

#include "base/arena.h"
#include "math/random.h"
#include "stepped/blocks.h"

enum { BODIES = 30, PAIRS_MAX = 100, ALL = RB_BLOCK * BODIES };

/* A system whose pairs join bodies at random, and the same as a dense matrix. */
struct system {
	int pair[PAIRS_MAX][2], pair_count;
	double dense[ALL][ALL];
	struct rb_arena arena;
	struct rb_blocks blocks;
};
static struct system s;

static double some(uint64_t stream, uint64_t k)
{
	return 2 * rb_random_unit(4, stream, k) - 1;
}

static void put(int i, int j, double value)
{
	const int a = i / RB_BLOCK, b = j / RB_BLOCK;
	bool turned;
	rb_block *const block = rb_blocks_at(&s.blocks, a, b, &turned);

	assert_non_null(block);
	if (turned)
		block->m[j % RB_BLOCK][i % RB_BLOCK] = value;
	else
		block->m[i % RB_BLOCK][j % RB_BLOCK] = value;
}

/* Each pair adds (row)(row)^T with a row over both of its bodies, six times; the diagonal some more: positive. */
static void make(uint64_t seed, int pair_count, double diagonal)
{
	s.pair_count = 0;
	memset(s.dense, 0, sizeof s.dense);
	for (uint64_t k = 0; s.pair_count < pair_count; k++) {
		const int a = (int)(BODIES * rb_random_unit(seed, 1, k));
		const int b = (int)(BODIES * rb_random_unit(seed, 2, k));

		if (a == b)
			continue;
		s.pair[s.pair_count][0] = a < b ? a : b;
		s.pair[s.pair_count++][1] = a < b ? b : a;
	}
	for (int p = 0; p < s.pair_count; p++)
		for (int r = 0; r < RB_BLOCK; r++) {
			double row[2 * RB_BLOCK];
			int at[2 * RB_BLOCK];

			for (int c = 0; c < 2 * RB_BLOCK; c++) {
				at[c] = RB_BLOCK * s.pair[p][c / RB_BLOCK] + c % RB_BLOCK;
				row[c] = some(seed + 7, (uint64_t)(100 * p + 12 * r + c));
			}
			for (int c = 0; c < 2 * RB_BLOCK; c++)
				for (int d = 0; d < 2 * RB_BLOCK; d++)
					s.dense[at[c]][at[d]] += row[c] * row[d];
		}
	for (int i = 0; i < ALL; i++)
		s.dense[i][i] += diagonal;
	assert_true(rb_blocks_plan(&s.blocks, BODIES, (const int(*)[2])s.pair, s.pair_count, 1e12,
	                           &s.arena));
	rb_blocks_clear(&s.blocks);
	for (int i = 0; i < ALL; i++)
		for (int j = 0; j < ALL; j++)
			if (s.dense[i][j] != 0)
				put(i, j, s.dense[i][j]);
}

/*
 * The residual of a solution by Cholesky's factors of a matrix A is below c n ulp |A| |x| (Higham, Accuracy and
 * Stability, 10.1), whatever the condition.
 */
static void a_solution_solves_the_system(void **state)
{
	double x[ALL], scratch[ALL], right[ALL];

	(void)state;
	for (uint64_t seed = 1; seed <= 12; seed++) {
		double matrix = 0, size = 0;

		make(seed, (int)(8 * seed), 1);
		for (int i = 0; i < ALL; i++)
			x[i] = right[i] = some(seed + 50, (uint64_t)i);
		assert_true(rb_blocks_factor(&s.blocks));
		rb_blocks_solve(&s.blocks, x, scratch);
		for (int i = 0; i < ALL; i++) {
			double row = 0;

			for (int j = 0; j < ALL; j++)
				row += fabs(s.dense[i][j]);
			matrix = fmax(matrix, row);
			size = fmax(size, fabs(x[i]));
		}
		for (int i = 0; i < ALL; i++) {
			double sum = 0;

			for (int j = 0; j < ALL; j++)
				sum += s.dense[i][j] * x[j];
			assert_near(sum, right[i], 4 * ALL * 0x1p-52 * matrix * size);
		}
		rb_arena_reset(&s.arena);
	}
	rb_arena_release(&s.arena);
}

static void blocks_are_there_for_pairs_and_bodies_and_in_one_place(void **state)
{
	bool turned, mirrored;

	(void)state;
	make(3, 20, 1);
	for (int a = 0; a < BODIES; a++)
		assert_non_null(rb_blocks_at(&s.blocks, a, a, &turned));
	for (int p = 0; p < s.pair_count; p++) {
		rb_block *const block = rb_blocks_at(&s.blocks, s.pair[p][0], s.pair[p][1],
		                                     &turned);

		assert_ptr_equal(block,
		                 rb_blocks_at(&s.blocks, s.pair[p][1], s.pair[p][0], &mirrored));
		assert_true(turned != mirrored);
	}
	/* each body has a place of its own in the order of elimination */
	bool taken[BODIES] = {false};
	for (int a = 0; a < BODIES; a++) {
		assert_in_range(s.blocks.place[a], 0, BODIES - 1);
		assert_false(taken[s.blocks.place[a]]);
		taken[s.blocks.place[a]] = true;
	}
	rb_arena_release(&s.arena);
}

static void a_matrix_that_is_not_positive_is_refused(void **state)
{
	(void)state;
	make(4, 30, 1);
	bool turned;
	rb_blocks_at(&s.blocks, 7, 7, &turned)->m[3][3] = -1;
	assert_false(rb_blocks_factor(&s.blocks));
	make(4, 30, 1);
	rb_blocks_at(&s.blocks, 7, 7, &turned)->m[3][3] = (double)NAN;
	assert_false(rb_blocks_factor(&s.blocks));
	rb_arena_release(&s.arena);
}

/* A chain has factors without fill: its work grows with its length. Too much work is not begun. */
static void work_is_told_and_limited(void **state)
{
	int pair[BODIES - 1][2];
	double work[2];

	(void)state;
	for (int k = 0; k + 1 < BODIES; k++) {
		pair[k][0] = k;
		pair[k][1] = k + 1;
	}
	for (int k = 0; k < 2; k++) {
		const int count = k == 0 ? BODIES / 2 : BODIES;

		assert_true(rb_blocks_plan(&s.blocks, count, (const int(*)[2])pair, count - 1, 1e12,
		                           &s.arena));
		assert_int_equal(s.blocks.first[count], 2 * count - 1);
		work[k] = s.blocks.work;
	}
	assert_true(work[0] > 0 && work[1] < 2.2 * work[0]);
	assert_false(rb_blocks_plan(&s.blocks, BODIES, (const int(*)[2])pair, BODIES - 1,
	                            0.9 * work[1], &s.arena));
	rb_arena_release(&s.arena);
}

/* Neighbours in a lattice, as of a heap: 27 times 27 by `layers`. Returns the pairs. */
static int lattice(int (*pair)[2], int layers)
{
	enum { SIDE = 27 };
	const int step[3] = {1, SIDE, SIDE * SIDE};
	int count = 0;

	for (int i = 0; i < SIDE * SIDE * layers; i++) {
		const bool has[3] = {i % SIDE + 1 < SIDE, i / SIDE % SIDE + 1 < SIDE,
		                     i / (SIDE * SIDE) + 1 < layers};

		for (int k = 0; k < 3; k++) {
			if (!has[k])
				continue;
			pair[count][0] = i;
			pair[count++][1] = i + step[k];
		}
	}
	return count;
}

static void an_order_that_is_given_up_takes_memory_by_bodies_not_by_their_square(void **slot)
{
	enum { LAYERS = 30, LARGE = 27 * 27 * LAYERS };
	static int pair[3 * LARGE][2];
	struct rb_arena arena = {0};
	struct rb_blocks blocks;

	(void)slot;
	assert_false(rb_blocks_plan(&blocks, LARGE, (const int(*)[2])pair, lattice(pair, LAYERS),
	                            1e7, &arena));
	/* some 20 numbers for each body and its neighbours, and what the first thousands add */
	assert_true(arena.high_water < (size_t)200 * LARGE);
	rb_arena_release(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_solution_solves_the_system),
		cmocka_unit_test(blocks_are_there_for_pairs_and_bodies_and_in_one_place),
		cmocka_unit_test(a_matrix_that_is_not_positive_is_refused),
		cmocka_unit_test(work_is_told_and_limited),
		cmocka_unit_test(
			an_order_that_is_given_up_takes_memory_by_bodies_not_by_their_square),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
