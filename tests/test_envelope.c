/* SPDX-License-Identifier: MIT */
/* math/envelope: blocks of all sizes, rows that reach back by different ways, systems that are singular. */
#include "math/envelope.h"

#include "support.h"

enum { ROWS = 29 };

struct system {
	struct rb_envelope e;
	struct rb_envelope_block block[ROWS];
	int of[ROWS];
	double pivot[ROWS], value[2 * ROWS * (ROWS + 1)], full[ROWS][ROWS];
};

static double wave(int r, int c)
{
	return sin(1 + 3 * r + 7 * c);
}

/* Blocks of 1, 2 .. rows, at most `most`, each of which reaches back to the block that is `far` before it. */
static void lay_out(struct system *s, int most, int far)
{
	*s = (struct system){.e = {.n = ROWS}};
	s->e.block = s->block;
	s->e.of = s->of;
	s->e.pivot = s->pivot;
	s->e.value = s->value;
	for (int r = 0, i = 0; r < ROWS; i++) {
		const int count = 1 + i % most, back = i - 1 - i % far;

		s->block[i] = (struct rb_envelope_block){
			.begin = r, .count = r + count > ROWS ? ROWS - r : count};
		s->block[i].first = s->block[back > 0 ? back : 0].begin;
		r += s->block[i].count;
		s->e.block_count = i + 1;
	}
	assert_true(rb_envelope_lay_out(&s->e) <= rb_envelope_size_max(ROWS));
}

/* Positive definite: with diagonals that outweigh the rest of their rows. */
static void fill(struct system *s)
{
	for (int r = 0; r < ROWS; r++) {
		const int first = s->block[s->of[r]].first;
		size_t stride;
		double *const row = rb_envelope_row(&s->e, r, &stride);

		for (int c = first; c <= r; c++) {
			const double x = r == c ? ROWS + r : wave(r, c);

			s->full[r][c] = s->full[c][r] = x;
			row[(size_t)(c - first) * stride] = x;
		}
	}
}

static void blocks_of_all_sizes_and_reaches_are_solved(void **slot)
{
	struct system s;

	(void)slot;
	for (int most = 1; most <= RB_ENVELOPE_BLOCK; most++)
		for (int far = 1; far < 5; far++) {
			double x[ROWS];

			lay_out(&s, most, far);
			fill(&s);
			assert_true(rb_envelope_factor(&s.e, 0x1p-26));
			for (int right = 0; right < 2; right++) {
				for (int r = 0; r < ROWS; r++) {
					x[r] = 0;
					for (int c = 0; c < ROWS; c++)
						x[r] += s.full[r][c] * (right ? c - 4 : 1);
				}
				rb_envelope_solve(&s.e, x);
				for (int r = 0; r < ROWS; r++)
					assert_near(x[r], right ? r - 4 : 1, 1e-13);
			}
		}
}

/* A row that is the sum of two others, exactly and but for a part that is less than what is asked for. */
static void dependent_rows_are_seen(void **slot)
{
	struct system s;

	(void)slot;
	for (int m = 0; m < 3; m++) {
		lay_out(&s, 3, 1);
		for (int r = 0; r < ROWS; r++) {
			size_t stride;
			double *const row = rb_envelope_row(&s.e, r, &stride);

			row[(size_t)(r - s.block[s.of[r]].first) * stride] = r == 2 ? 2 + m * 1e-9
			                                                            : 1;
		}
		size_t stride;
		double *const row = rb_envelope_row(&s.e, 2, &stride);

		assert_int_equal(s.block[s.of[2]].first, 0);
		row[0] = row[stride] = 1;
		assert_true(rb_envelope_factor(&s.e, m == 2 ? 1e-10 : 1e-8) == (m == 2));
	}
}

/* What is no number is no positive system. */
static void not_a_number_is_no_pivot(void **slot)
{
	struct system s;
	size_t stride;

	(void)slot;
	lay_out(&s, 5, 1);
	fill(&s);
	rb_envelope_row(&s.e, 7, &stride)[0] = (double)NAN;
	assert_false(rb_envelope_factor(&s.e, 0));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(blocks_of_all_sizes_and_reaches_are_solved),
		cmocka_unit_test(dependent_rows_are_seen),
		cmocka_unit_test(not_a_number_is_no_pivot),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
