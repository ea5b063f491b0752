/* SPDX-License-Identifier: MIT */
#include "math/decay.h"

#include <float.h>

#include "math/random.h"
#include "support.h"

/* x(s) by long double, without the sums that cancel: k s above 1/16 only. */
static long double place(long double k, long double s, const double x[3])
{
	const long double tau = -expm1l(-k * s) / k;

	return x[0] + tau * x[1] + (s - tau) / k * x[2];
}

static void its_functions_are_exact_to_rounding_everywhere(void **state)
{
	(void)state;
	for (int n = -1000; n <= 360; n++) {
		const double z = exp2(n / 40.0);
		const struct rb_decay d = rb_decay_at(z);
		/* terms of both signs fall off by then */
		long double f[4] = {0}, term[4] = {1, 1, 0.5L, 1.0L / 6};

		for (int j = 1; z <= 1 && j < 40; j++)
			for (int m = 0; m < 4; m++) {
				f[m] += term[m];
				term[m] *= -(long double)z / (j + m);
			}
		if (z > 1) {
			f[0] = expl(-(long double)z);
			for (int m = 1; m < 4; m++)
				f[m] = ((m < 3 ? 1.0L : 0.5L) - f[m - 1]) / z;
		}
		assert_true(fabsl(d.left / f[0] - 1) <= 4 * DBL_EPSILON);
		assert_true(fabsl(d.once / f[1] - 1) <= 2 * DBL_EPSILON);
		assert_true(fabsl(d.twice / f[2] - 1) <= 4 * DBL_EPSILON);
		assert_true(fabsl(d.thrice / f[3] - 1) <= 8 * DBL_EPSILON);
	}
	assert_true(rb_decay_at(0).twice == 0.5);
	assert_true(rb_decay_at(1e9).left == 0);
}

static void a_time_is_that_of_its_way(void **state)
{
	(void)state;
	for (int n = 0; n < 200; n++) {
		const double k = exp2(rb_random_unit(1, 0, (uint64_t)n) * 20 - 10);
		const double tau = rb_random_unit(1, 1, (uint64_t)n) / k;
		const double s = rb_decay_time(k, tau);

		/* near the end of all ways a rounding of tau is much of the time */
		assert_true(fabs(s * rb_decay_at(k * s).once - tau) <= 4 * DBL_EPSILON * tau);
	}
	assert_true(isinf(rb_decay_time(2, 0.5)));
	assert_true(rb_decay_time(1e-9, 3) > 3);
}

/* The first fall by small steps and bisection. */
static double found(double k, const double x[3], double max)
{
	enum { STEPS = 20000 };
	double low = 0;

	for (int n = 1; n <= STEPS; n++) {
		double high = max * n / STEPS;

		if (!(place(k, high, x) <= 0)) {
			low = high;
			continue;
		}
		for (int round = 0; round < 80; round++) {
			const double middle = 0.5 * (low + high);

			*(place(k, middle, x) > 0 ? &low : &high) = middle;
		}
		return low;
	}
	return HUGE_VAL;
}

static void the_first_fall_is_found_from_either_side_of_the_final_speed(void **state)
{
	int falls = 0;

	(void)state;
	for (int n = 0; n < 400; n++) {
		const double k = exp2(rb_random_unit(2, 0, (uint64_t)n) * 8 - 3);
		const double x[3] = {rb_random_unit(2, 1, (uint64_t)n),
		                     4 * rb_random_unit(2, 2, (uint64_t)n) - 2.5,
		                     4 * rb_random_unit(2, 3, (uint64_t)n) - 3};
		const double s = rb_decay_falls(k, x[0], x[1], x[2], 4), other = found(k, x, 4);

		assert_int_equal(isinf(s), isinf(other));
		if (isinf(s))
			continue;
		falls++;
		/* of the place by some roundings of all that is summed */
		assert_true(fabsl(place(k, s, x)) <=
		            16 * DBL_EPSILON * (x[0] + fabs(x[1]) * s + fabs(x[2]) * s * s));
		assert_true(fabs(s - other) <= 1e-7 * other);
	}
	assert_in_range(falls, 100, 390);
	/* what is thrown from the ground comes back, sooner than without drag */
	const double back = rb_decay_falls(0.5, 0, 3, -10, 10);
	assert_true(back < 0.6 && back > 0.5);
	assert_true(fabsl(place(0.5, back, (double[]){0, 3, -10})) <= 1e-15);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(its_functions_are_exact_to_rounding_everywhere),
		cmocka_unit_test(a_time_is_that_of_its_way),
		cmocka_unit_test(the_first_fall_is_found_from_either_side_of_the_final_speed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
