/* SPDX-License-Identifier: MIT */
/* src/math/random.h */
#include "support.h"

#include "math/random.h"

static void random_numbers_are_uniform_and_streams_do_not_resemble_each_other(void **state)
{
	enum { COUNT = 100000 };
	double sum = 0, sum_of_squares = 0, seeds = 0, streams = 0, neighbours = 0;

	(void)state;
	for (uint64_t i = 0; i < COUNT; i++) {
		const double u = rb_random_unit(7, 3, i) - 0.5;
		assert_true(u >= -0.5 && u < 0.5);
		sum += u;
		sum_of_squares += u * u;
		seeds += u * (rb_random_unit(8, 3, i) - 0.5);
		streams += u * (rb_random_unit(7, 4, i) - 0.5);
		neighbours += u * (rb_random_unit(7, 3, i + 1) - 0.5);
	}
	/* five standard deviations of a sum of COUNT terms: 1/12 is the variance of u, 1/144 of a product,
	 * 1/180 of a square */
	const double root = sqrt((double)COUNT);
	assert_near(sum, 0, 5 * root / sqrt(12));
	assert_near(sum_of_squares, COUNT / 12.0, 5 * root / sqrt(180));
	assert_near(seeds, 0, 5 * root / 12);
	assert_near(streams, 0, 5 * root / 12);
	assert_near(neighbours, 0, 5 * root / 12);
	assert_true(rb_random_unit(7, 3, 5) == rb_random_unit(7, 3, 5));
}

/* Of 64 bits half change, whichever bit of whichever counter does: 200 cases have 6400 of 12800, a standard deviation of 57. */
static void one_bit_of_a_counter_changes_half_of_the_number(void **state)
{
	(void)state;
	for (int which = 0; which < 3; which++) {
		for (int bit = 0; bit < 64; bit += 7) {
			int changed = 0;

			for (uint64_t k = 0; k < 200; k++) {
				uint64_t c[3] = {k, k + 17, 3 * k};
				const uint64_t before = rb_random_bits(c[0], c[1], c[2]);

				c[which] ^= UINT64_C(1) << bit;
				changed += __builtin_popcountll(before ^
				                                rb_random_bits(c[0], c[1], c[2]));
			}
			assert_in_range(changed, 6400 - 300, 6400 + 300);
		}
	}
}

static void a_number_depends_on_its_counters_alone(void **state)
{
	uint64_t forward[64];

	(void)state;
	for (uint64_t i = 0; i < 64; i++)
		forward[i] = rb_random_bits(5, i % 3, i);
	for (uint64_t i = 64; i-- > 0;)
		assert_true(rb_random_bits(5, i % 3, i) == forward[i]);
}

/* Its extremes are those of 53 bits: never 1. */
static void a_unit_number_is_the_upper_53_bits(void **state)
{
	(void)state;
	for (uint64_t i = 0; i < 1000; i++)
		assert_true(rb_random_unit(1, 2, i) * 0x1p53 ==
		            (double)(rb_random_bits(1, 2, i) >> 11));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(random_numbers_are_uniform_and_streams_do_not_resemble_each_other),
		cmocka_unit_test(one_bit_of_a_counter_changes_half_of_the_number),
		cmocka_unit_test(a_number_depends_on_its_counters_alone),
		cmocka_unit_test(a_unit_number_is_the_upper_53_bits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
