/* SPDX-License-Identifier: MIT */
/* math/dense: systems with one solution, with many, and with bands of zeros. */
#include "math/dense.h"

#include "support.h"

enum { MOST = 12 };

static struct rb_dense take(int n, double *store, int *places)
{
	return (struct rb_dense){.matrix = store,
	                         .right = store + MOST * MOST,
	                         .size = store + MOST * MOST + MOST,
	                         .noise = store + MOST * MOST + 2 * MOST,
	                         .found = store + MOST * MOST + 3 * MOST,
	                         .last = places,
	                         .down = places + MOST,
	                         .pivot = places + 2 * MOST,
	                         .from = places + 3 * MOST,
	                         .order = places + 4 * MOST,
	                         .n = n};
}

static double entry(int r, int c)
{
	return sin(1 + 3 * r + 7 * c) + (r == c ? 4 : 0);
}

static void a_regular_system_is_solved(void **slot)
{
	double store[MOST * MOST + 4 * MOST];
	int places[5 * MOST];

	(void)slot;
	for (int n = 1; n <= MOST; n++) {
		struct rb_dense d = take(n, store, places);

		for (int r = 0; r < n; r++) {
			d.right[r] = 0;
			for (int c = 0; c < n; c++) {
				d.matrix[r * n + c] = entry(r, c);
				d.right[r] += entry(r, c) * (c + 1);
			}
		}
		rb_dense_solve(&d);
		assert_false(d.open);
		for (int k = 0; k < n; k++)
			assert_near(d.right[k], k + 1, 1e-13);
	}
}

/* Rows that need to be swapped, and zeros besides a band. */
static void a_band_is_solved(void **slot)
{
	double store[MOST * MOST + 4 * MOST];
	int places[5 * MOST];
	struct rb_dense d = take(MOST, store, places);

	(void)slot;
	for (int r = 0; r < MOST; r++) {
		d.right[r] = 0;
		for (int c = 0; c < MOST; c++) {
			const double x = c - r == 1 ? 3 : r - c == 1 ? 2 : r == c ? 1e-3 : 0;

			d.matrix[r * MOST + c] = x;
			d.right[r] += x * (1 - c);
		}
	}
	rb_dense_solve(&d);
	assert_false(d.open);
	for (int k = 0; k < MOST; k++)
		assert_near(d.right[k], 1 - k, 1e-12);
}

/* Row r of a band of chains in parallel, some of which depend on others, some weakly: rows to be swapped, late and open columns. */
static double banded_entry(int kind, int r, int c)
{
	const int off = abs(r - c);

	if (off > 3)
		return 0;
	if (kind == 0)
		return c - r == 1 ? 3 : r - c == 1 ? 2 : r == c ? 1e-3 : 0.1;
	/* pairs of rows that are the same but for next to nothing, or nothing */
	if (off == 0)
		return 1 + (kind == 1 ? 1e-3 * (r % 2) : 0);
	return abs(r / 2 - c / 2) > 1 ? 0 : r / 2 == c / 2 ? 1 : 0.25;
}

static void what_is_beside_a_known_band_is_never_read(void **slot)
{
	(void)slot;
	for (int kind = 0; kind < 3; kind++) {
		double full_store[MOST * MOST + 4 * MOST], store[MOST * MOST + 4 * MOST];
		int full_places[5 * MOST], places[5 * MOST], first[MOST];
		struct rb_dense full = take(MOST, full_store, full_places),
				d = take(MOST, store, places);

		for (int r = 0; r < MOST; r++) {
			first[r] = r > 3 ? r - 3 : 0;
			d.last[r] = r + 3 < MOST ? r + 3 : MOST - 1;
			d.right[r] = full.right[r] = 1 + r % 5;
			for (int c = 0; c < MOST; c++) {
				full.matrix[r * MOST + c] = banded_entry(kind, r, c);
				d.matrix[r * MOST + c] = c >= first[r] && c <= d.last[r]
				                                 ? banded_entry(kind, r, c)
				                                 : (double)NAN;
			}
		}
		d.first = first;
		rb_dense_solve(&full);
		rb_dense_solve(&d);
		assert_true(d.open == full.open && d.late == full.late);
		assert_true(d.products < full.products);
		assert_memory_equal(d.right, full.right, sizeof *d.right * MOST);
		for (int k = 0; k < MOST; k++)
			d.right[k] = full.right[k] = 2 - k % 3;
		rb_dense_again(&full);
		rb_dense_again(&d);
		assert_memory_equal(d.right, full.right, sizeof *d.right * MOST);
		for (int k = 0; k < MOST; k++) {
			assert_true(rb_dense_is_open(&d, k) == rb_dense_is_open(&full, k));
			if (!rb_dense_is_open(&d, k))
				continue;
			rb_dense_opened(&full, k);
			rb_dense_opened(&d, k);
			assert_memory_equal(d.right, full.right, sizeof *d.right * MOST);
		}
		assert_true(kind != 2 || d.open);
		assert_true(kind != 1 || d.late > 0);
	}
}

/* Rows are swapped several times over, and one unknown is open. */
static void another_right_side_needs_no_new_elimination(void **slot)
{
	double store[MOST * MOST + 4 * MOST], kept[MOST * MOST];
	int places[5 * MOST];
	struct rb_dense d = take(MOST, store, places);

	(void)slot;
	for (int r = 0; r < MOST; r++) {
		d.right[r] = 1;
		for (int c = 0; c < MOST; c++)
			kept[r * MOST + c] = r == 5 || c == 5 || (r + c) % 5 == 1
			                             ? 0
			                             : sin(1 + 3 * r * c + 7 * c + r * r);
	}
	memcpy(d.matrix, kept, sizeof kept);
	rb_dense_solve(&d);
	assert_true(d.open);
	for (int r = 0; r < MOST; r++) {
		d.right[r] = 0;
		for (int c = 0; c < MOST; c++)
			d.right[r] += kept[r * MOST + c] * (c == 5 ? 0 : c - 4);
	}
	rb_dense_again(&d);
	for (int k = 0; k < MOST; k++)
		assert_near(d.right[k], k == 5 ? 0 : k - 4, 1e-12);
}

/* Two columns that are the same to rounding: the second of them stays zero, and all equations hold. */
static void what_nothing_determines_is_left_open(void **slot)
{
	const double wanted[3] = {2, -1, 0.5};
	double store[MOST * MOST + 4 * MOST], kept[9], right[3];
	int places[5 * MOST];

	(void)slot;
	for (int exact = 0; exact < 2; exact++) {
		struct rb_dense d = take(3, store, places);

		for (int r = 0; r < 3; r++) {
			right[r] = 0;
			for (int c = 0; c < 3; c++) {
				/* two rows add up to the third, and two columns are the same */
				const double a[3] = {1 + r % 2, 1 / 3.0 + r, 1 + r % 2};
				const double b[3] = {3, 2 / 3.0 + 1, 3};
				const double shake = exact || c < 2 ? 1 : 1 + 4e-16;

				kept[3 * r + c] = (r < 2 ? a[c] : b[c]) * shake;
				right[r] += kept[3 * r + c] * wanted[c];
			}
		}
		memcpy(d.matrix, kept, sizeof kept);
		memcpy(d.right, right, sizeof right);
		rb_dense_solve(&d);
		assert_true(d.open);
		for (int r = 0; r < 3; r++)
			assert_near(kept[3 * r] * d.right[0] + kept[3 * r + 1] * d.right[1] +
			                    kept[3 * r + 2] * d.right[2],
			            right[r], 1e-13);
		assert_true(d.right[2] == 0);
	}
}

/* What a force along `c` at point q does to point p of a body of mass and inertia 1, along `r`. */
static double yields(const double p[3], int r, const double q[3], int c)
{
	const double along = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];

	return (r == c ? 1 + along : 0) - q[r] * p[c];
}

/*
 * Two points of a body that are held: how much they press along the line between them nothing says. Where that is all but
 * in the plane of two axes, rounding must not say it for the third.
 */
static void what_is_open_but_for_rounding_is_seen_at_the_end(void **slot)
{
	double store[MOST * MOST + 4 * MOST], kept[36];
	int places[5 * MOST];

	(void)slot;
	for (int m = 0; m < 64; m++) {
		const double tilt = ldexp(2e-12, -m % 10), turn = 0.1 * m;
		const double point[2][3] = {{0.3 * cos(turn), 0.3 * sin(turn), -0.1},
		                            {-0.3 * cos(turn), -0.3 * sin(turn), -0.1 + tilt}};
		struct rb_dense d = take(6, store, places);

		for (int r = 0; r < 6; r++) {
			d.right[r] = 0;
			for (int c = 0; c < 6; c++) {
				kept[6 * r + c] = yields(point[r / 3], r % 3, point[c / 3], c % 3);
				d.right[r] += kept[6 * r + c] * (c % 3 == 2 ? 1 : 0.1);
			}
		}
		memcpy(d.matrix, kept, sizeof kept);
		rb_dense_solve(&d);
		for (int k = 0; k < 6; k++)
			assert_true(fabs(d.right[k]) < 100);
	}
}

/*
 * What a column adds to another one is a little of a third, twice over: what the last one has of its own is the rounding of
 * that, hundreds of times, and not to be solved for.
 */
static void rounding_that_small_pivots_enlarge_is_open(void **slot)
{
	double store[MOST * MOST + 4 * MOST], way[4][5];
	int places[5 * MOST];

	(void)slot;
	for (int m = 0; m < 64; m++) {
		struct rb_dense d = take(5, store, places);

		for (int r = 0; r < 5; r++)
			for (int k = 0; k < 4; k++)
				way[k][r] = sin(1 + 5 * m + 7 * r * r + 3 * k * (r + 1));
		for (int r = 0; r < 5; r++) {
			const double column[5] = {way[0][r], way[0][r] + 0.04 * way[1][r],
			                          way[1][r] + 0.04 * way[2][r], way[2][r],
			                          way[3][r]};

			memcpy(d.matrix + 5 * r, column, sizeof column);
			d.right[r] = way[0][r] + way[3][r];
		}
		rb_dense_solve(&d);
		assert_true(d.open);
		for (int k = 0; k < 5; k++)
			assert_true(fabs(d.right[k]) < 100);
	}
}

/* Small rows are those of heavy bodies, whose unknowns are not open; that some wait costs no accuracy. */
static void a_small_row_is_not_a_rest(void **slot)
{
	double store[MOST * MOST + 4 * MOST], kept[MOST * MOST];
	int places[5 * MOST];
	struct rb_dense d = take(MOST, store, places);

	(void)slot;
	for (int r = 0; r < MOST; r++) {
		d.right[r] = 0;
		for (int c = 0; c < MOST; c++) {
			kept[r * MOST + c] = entry(r, c) * (r % 2 ? 1e-10 : 1);
			d.right[r] += kept[r * MOST + c] * (c - 4);
		}
	}
	memcpy(d.matrix, kept, sizeof kept);
	rb_dense_solve(&d);
	assert_false(d.open);
	for (int k = 0; k < MOST; k++)
		assert_near(d.right[k], k - 4, 1e-12);
}

/*
 * The loads of four corners, which are open by one but for a little that a fifth unknown can do better: the column that is
 * nearly spent is not used first, which would answer a small right side with large loads.
 */
static void a_column_nearly_spent_waits(void **slot)
{
	const double base[4][4] = {{2, 0, 1, 1}, {0, 2, 1, 1}, {1, 1, 2, 0}, {1, 1, 0, 2}};
	double store[MOST * MOST + 4 * MOST];
	int places[5 * MOST];

	(void)slot;
	for (int m = 0; m < 12; m++) {
		const double nearly = ldexp(0.01, -m);
		struct rb_dense d = take(5, store, places);

		for (int r = 0; r < 4; r++)
			for (int c = 0; c < 4; c++)
				d.matrix[5 * r + c] = base[r][c];
		for (int r = 0; r < 5; r++) {
			d.matrix[5 * r + 4] = r == 4;
			d.right[r] = r == 4;
		}
		for (int c = 0; c < 4; c++)
			d.matrix[20 + c] = nearly * (c < 2 ? 1 : -1);
		rb_dense_solve(&d);
		for (int k = 0; k < 5; k++)
			assert_true(fabs(d.right[k]) < 2);
	}
}

/* What is open can be added to a solution, and is all that can: the matrix takes it to nothing. */
static void what_solutions_differ_by_is_known(void **slot)
{
	const double base[4][4] = {{2, 0, 1, 1}, {0, 2, 1, 1}, {1, 1, 2, 0}, {1, 1, 0, 2}};
	double store[MOST * MOST + 4 * MOST];
	int places[5 * MOST], open = 0;
	struct rb_dense d = take(4, store, places);

	(void)slot;
	for (int r = 0; r < 4; r++) {
		for (int c = 0; c < 4; c++)
			d.matrix[4 * r + c] = base[r][c];
		d.right[r] = 4;
		d.found[r] = (double)NAN; /* what is left in there must not matter */
	}
	rb_dense_solve(&d);
	assert_true(d.open);
	for (int r = 0; r < 4; r++) {
		double sum = 0;

		for (int c = 0; c < 4; c++)
			sum += base[r][c] * d.right[c];
		assert_near(sum, 4, 1e-14);
	}
	for (int k = 0; k < 4; k++) {
		if (!rb_dense_is_open(&d, k))
			continue;
		assert_near(d.right[k], 0, 0);
		open++;
		rb_dense_opened(&d, k);
		assert_near(d.right[k], 1, 0);
		for (int r = 0; r < 4; r++) {
			double sum = 0;

			for (int c = 0; c < 4; c++)
				sum += base[r][c] * d.right[c];
			assert_near(sum, 0, 1e-15);
		}
	}
	assert_int_equal(open, 1);
}

/* Of several that are open each has a solution of its own, in which the others are nothing. */
static void what_is_open_is_told_one_at_a_time(void **slot)
{
	double store[MOST * MOST + 4 * MOST];
	int places[5 * MOST], open = 0;
	struct rb_dense d = take(4, store, places);

	(void)slot;
	for (int r = 0; r < 4; r++) {
		for (int c = 0; c < 4; c++)
			d.matrix[4 * r + c] = r / 2 ==
			                      c / 2; /* two pairs that are the same twice */
		d.right[r] = 2;
	}
	rb_dense_solve(&d);
	for (int round = 0; round < 2; round++)
		for (int k = 0; k < 4; k++) {
			if (!rb_dense_is_open(&d, k))
				continue;
			open++;
			rb_dense_opened(&d, k);
			for (int c = 0; c < 4; c++)
				assert_near(d.right[c], c == k ? 1 : c / 2 == k / 2 ? -1 : 0, 0);
		}
	assert_int_equal(open, 4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_regular_system_is_solved),
		cmocka_unit_test(a_band_is_solved),
		cmocka_unit_test(what_is_beside_a_known_band_is_never_read),
		cmocka_unit_test(another_right_side_needs_no_new_elimination),
		cmocka_unit_test(what_nothing_determines_is_left_open),
		cmocka_unit_test(what_is_open_but_for_rounding_is_seen_at_the_end),
		cmocka_unit_test(rounding_that_small_pivots_enlarge_is_open),
		cmocka_unit_test(a_small_row_is_not_a_rest),
		cmocka_unit_test(a_column_nearly_spent_waits),
		cmocka_unit_test(what_is_open_is_told_one_at_a_time),
		cmocka_unit_test(what_solutions_differ_by_is_known),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
