/* SPDX-License-Identifier: MIT */
/* src/math/vec3.h */
#include "support.h"

#include <float.h>

#include "math/random.h"
#include "math/vec3.h"

static double between(double low, double high, uint64_t stream, uint64_t index)
{
	return low + (high - low) * rb_random_unit(1, stream, index);
}

static rb_vec3 some_vector(uint64_t index)
{
	return rb_vec3_of(between(-2, 2, 10, index), between(-2, 2, 11, index),
	                  between(-2, 2, 12, index));
}

static void assert_same_vector(rb_vec3 a, rb_vec3 b, double tol)
{
	assert_near(a.x, b.x, tol);
	assert_near(a.y, b.y, tol);
	assert_near(a.z, b.z, tol);
}

static void the_length_of_what_is_no_number_is_none(void **slot)
{
	(void)slot;
	assert_true(isnan(rb_vec3_length((rb_vec3){(double)NAN, 0, 0})));
	assert_true(isnan(rb_vec3_length((rb_vec3){0, 1e300, (double)NAN})));
}

static void cross_is_right_handed_and_across_both(void **state)
{
	(void)state;
	assert_same_vector(rb_vec3_cross(rb_vec3_of(1, 0, 0), rb_vec3_of(0, 1, 0)),
	                   rb_vec3_of(0, 0, 1), 0);
	for (uint64_t k = 0; k < 100; k++) {
		const rb_vec3 a = some_vector(k), b = some_vector(k + 100);
		const rb_vec3 c = rb_vec3_cross(a, b);
		assert_near(rb_vec3_dot(a, c), 0, 1e-14);
		assert_near(rb_vec3_dot(b, c), 0, 1e-14);
	}
}

static void length_holds_from_the_smallest_to_the_largest_vector(void **state)
{
	(void)state;
	for (int e = -1070; e <= 1021; e++)
		assert_near(rb_vec3_length(rb_vec3_of(ldexp(3, e), 0, ldexp(-4, e))) / ldexp(5, e),
		            1, 4e-16);
	assert_near(rb_vec3_length(rb_vec3_of(0, 0, 0)), 0, 0);
	assert_true(isinf(rb_vec3_length(rb_vec3_of(1, -(double)INFINITY, 0))));
	assert_true(isnan(rb_vec3_length(rb_vec3_of((double)NAN, 1, 1))));
	assert_true(isnan(rb_vec3_length(rb_vec3_of((double)NAN, (double)NAN, (double)NAN))));
}

static void unit_has_length_one_whatever_the_size(void **state)
{
	const rb_vec3 fallback = {0, 1, 0};

	(void)state;
	for (int e = -1074; e <= 1022; e++)
		assert_near(rb_vec3_length(rb_vec3_unit(
				    rb_vec3_of(ldexp(1, e), ldexp(1, e), ldexp(1, e)), fallback)),
		            1, 4e-16);
	const double most = 1.7976931348623157e308;
	assert_near(rb_vec3_length(rb_vec3_unit(rb_vec3_of(most, -most, most), fallback)), 1,
	            4e-16);
	assert_same_vector(rb_vec3_unit(rb_vec3_of(0, 0, 0), fallback), fallback, 0);
}

static void across_is_a_unit_vector_at_right_angles(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 1000; k++) {
		/* the axes and their diagonals too */
		const rb_vec3 along = k < 27 ? rb_vec3_of((double)(k % 3) - 1,
		                                          (double)(k / 3 % 3) - 1,
		                                          (double)(k / 9) - 1)
		                             : some_vector(k);
		const rb_vec3 a = rb_vec3_unit(along, rb_vec3_of(1, 0, 0));
		const rb_vec3 b = rb_vec3_across(a);
		assert_near(rb_vec3_length(b), 1, 1e-15);
		assert_near(rb_vec3_dot(a, b), 0, 1e-15);
	}
}

static void finite_sees_each_coordinate(void **state)
{
	(void)state;
	assert_true(rb_vec3_finite(rb_vec3_of(1, -2, 1e308)));
	assert_false(rb_vec3_finite(rb_vec3_of((double)NAN, 0, 0)));
	assert_false(rb_vec3_finite(rb_vec3_of(0, (double)INFINITY, 0)));
	assert_false(rb_vec3_finite(rb_vec3_of(0, 0, -(double)INFINITY)));
}

/* In long double, which has 11 bits more, the sum of two doubles of like size is exact. */
static void a_sum_and_what_rounding_lost_of_it_are_the_exact_sum(void **state)
{
	int inexact = 0;

	(void)state;
	if (LDBL_MANT_DIG < 64)
		skip();
	for (uint64_t k = 0; k < 1000; k++) {
		const rb_vec3 a = some_vector(k),
			      b = rb_vec3_scale(ldexp(1, -(int)(k % 9)), some_vector(k + 5000));
		const rb_vec3 sum = rb_vec3_add(a, b);
		const rb_vec3 lost = rb_vec3_lost(a, b, sum);

		assert_true((long double)a.x + b.x == (long double)sum.x + lost.x);
		assert_true((long double)a.y + b.y == (long double)sum.y + lost.y);
		assert_true((long double)a.z + b.z == (long double)sum.z + lost.z);
		inexact += lost.x != 0;
	}
	assert_true(inexact > 500);
	/* the larger one may be either of the two */
	const rb_vec3 one = {1, 0x1p-60, 1}, other = {0x1p-60, 1, -1};
	const rb_vec3 lost = rb_vec3_lost(one, other, rb_vec3_add(one, other));
	assert_same_vector(lost, rb_vec3_of(0x1p-60, 0x1p-60, 0), 0);
}

static void what_is_rejected_lies_across_and_the_rest_along(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_vec3 a = some_vector(k);
		const rb_vec3 n = rb_vec3_unit(some_vector(k + 900), rb_vec3_of(1, 0, 0));
		const rb_vec3 across = rb_vec3_reject(a, n);

		assert_near(rb_vec3_dot(across, n), 0, 2e-15);
		assert_same_vector(rb_vec3_cross(rb_vec3_sub(a, across), n), rb_vec3_of(0, 0, 0),
		                   2e-15);
	}
}

static void the_largest_coordinate_counts_without_its_sign(void **state)
{
	(void)state;
	assert_near(rb_vec3_max_abs(rb_vec3_of(1, -3, 2)), 3, 0);
	assert_near(rb_vec3_max_abs(rb_vec3_of(-4, 3, 2)), 4, 0);
	assert_near(rb_vec3_max_abs(rb_vec3_of(1, 3, -5)), 5, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_length_of_what_is_no_number_is_none),
		cmocka_unit_test(cross_is_right_handed_and_across_both),
		cmocka_unit_test(length_holds_from_the_smallest_to_the_largest_vector),
		cmocka_unit_test(unit_has_length_one_whatever_the_size),
		cmocka_unit_test(across_is_a_unit_vector_at_right_angles),
		cmocka_unit_test(finite_sees_each_coordinate),
		cmocka_unit_test(a_sum_and_what_rounding_lost_of_it_are_the_exact_sum),
		cmocka_unit_test(what_is_rejected_lies_across_and_the_rest_along),
		cmocka_unit_test(the_largest_coordinate_counts_without_its_sign),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
