/* SPDX-License-Identifier: MIT */
/* src/constraint/exact_sum.h: sums without an order */
#include "support.h"

#include "constraint/exact_sum.h"
#include "math/random.h"

enum { COUNT = 500 };

/* Terms over many powers of two, of both signs. */
static double some_term(uint64_t stream, uint64_t k)
{
	const double sign = rb_random_bits(9, stream, k) & 1 ? 1 : -1;

	return sign * ldexp(1 + rb_random_unit(9, stream + 100, k),
	                    (int)(40 * rb_random_unit(9, stream + 200, k)) - 20);
}

static void shuffle(double *term, int count, uint64_t stream)
{
	for (int i = count - 1; i > 0; i--) {
		const int j = (int)((i + 1) * rb_random_unit(3, stream, (uint64_t)i));
		const double kept = term[i];

		term[i] = term[j];
		term[j] = kept;
	}
}

static bool same_bits(double a, double b)
{
	return memcmp(&a, &b, sizeof a) == 0;
}

static void no_order_changes_a_bit(void **state)
{
	double term[COUNT];

	(void)state;
	for (int count = 1; count <= COUNT; count = count < 10 ? count + 1 : 3 * count / 2) {
		for (int k = 0; k < count; k++)
			term[k] = some_term((uint64_t)count, (uint64_t)k);
		const double sum = rb_exact_sum(term, count);
		int plain = 0;

		for (uint64_t shuffled = 0; shuffled < 40; shuffled++) {
			shuffle(term, count, shuffled);
			assert_true(same_bits(rb_exact_sum(term, count), sum));
			double naive = 0;
			for (int k = 0; k < count; k++)
				naive += term[k];
			plain += naive != sum;
		}
		assert_true(count < 100 || plain > 0); /* which other sums are not free of */
	}
}

/* Where all that is left is what lies on the second grid. */
static void no_order_changes_a_bit_of_what_large_terms_leave(void **state)
{
	double term[COUNT];

	(void)state;
	for (int k = 0; k < COUNT; k += 2) {
		term[k] = some_term(1, (uint64_t)k);
		term[k + 1] = -term[k];
		if (k % 6 == 0) {
			term[k] = 0x1p-40 * some_term(2, (uint64_t)k);
			term[k + 1] = 0x1p-40 * some_term(3, (uint64_t)k);
		}
	}
	const double sum = rb_exact_sum(term, COUNT);
	assert_true(fabs(sum) < 1 && sum != 0);
	for (uint64_t shuffled = 0; shuffled < 200; shuffled++) {
		shuffle(term, COUNT, shuffled);
		assert_true(same_bits(rb_exact_sum(term, COUNT), sum));
	}
}

static void the_sum_of_opposite_terms_is_opposite(void **state)
{
	double term[COUNT], opposite[COUNT];

	(void)state;
	for (int count = 1; count <= COUNT; count += 7) {
		for (int k = 0; k < count; k++) {
			term[k] = some_term(7, (uint64_t)(k + count));
			opposite[k] = -term[k];
		}
		assert_true(rb_exact_sum(opposite, count) == -rb_exact_sum(term, count));
	}
}

/*
 * What lies below the second grid is dropped: for n terms less than 2^(3 log2 n - 104) of the largest; the two
 * partial sums are added with one rounding. Against long double, whose own rounding is 2^-64 of partial sums.
 */
static void a_sum_is_right_to_rounding(void **state)
{
	double term[COUNT];

	(void)state;
	for (int count = 3; count <= COUNT; count += 11) {
		long double wanted = 0, partial = 0;
		double largest = 0;

		for (int k = 0; k < count; k++) {
			term[k] = some_term(8, (uint64_t)(k + 3 * count));
			wanted += term[k];
			partial = fmaxl(partial, fabsl(wanted));
			largest = fmax(largest, fabs(term[k]));
		}
		const double bound = 0x1p-53 * fabs((double)wanted) +
		                     count * 0x1p-64 * (double)partial +
		                     pow(count, 3) * 0x1p-104 * largest;
		assert_near(rb_exact_sum(term, count), (double)wanted, bound);
	}
}

/* The small one has come through where the large ones cancel. */
static void what_cancels_leaves_the_rest_whole(void **state)
{
	const double term[] = {1e16, 3, -1e16, 1};

	(void)state;
	assert_true(rb_exact_sum(term, 4) == 4);
	assert_true(rb_exact_sum(term, 0) == 0);
	assert_true(rb_exact_sum(term + 1, 1) == 3);
	assert_true(rb_exact_sum((const double[]){0, -0.0, 0, 0}, 4) == 0);
}

static void the_largest_and_smallest_numbers_have_their_sums(void **state)
{
	const double large[] = {0x1p1000, 0x1p1000, -0x1p1000};
	const double small[] = {5e-324, 5e-324, 5e-324, -5e-324};

	(void)state;
	assert_true(rb_exact_sum(large, 3) == 0x1p1000);
	assert_true(rb_exact_sum(small, 4) == 2 * 5e-324);
}

static void what_is_not_a_number_is_not_lost(void **state)
{
	const double nan = (double)NAN;

	(void)state;
	for (int k = 0; k < 3; k++) {
		double zeros[3] = {0, -0.0, 0}, ones[3] = {1, -1, 1};

		zeros[k] = ones[k] = nan;
		assert_true(isnan(rb_exact_sum(zeros, 3)));
		assert_true(isnan(rb_exact_sum(ones, 3)));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_order_changes_a_bit),
		cmocka_unit_test(no_order_changes_a_bit_of_what_large_terms_leave),
		cmocka_unit_test(the_sum_of_opposite_terms_is_opposite),
		cmocka_unit_test(a_sum_is_right_to_rounding),
		cmocka_unit_test(what_cancels_leaves_the_rest_whole),
		cmocka_unit_test(the_largest_and_smallest_numbers_have_their_sums),
		cmocka_unit_test(what_is_not_a_number_is_not_lost),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
