/* SPDX-License-Identifier: MIT */
/* src/math/vec3.h mat3.h quat.h random.h */
#include "support.h"

#include "math/quat.h"
#include "math/random.h"

static const double pi = 3.14159265358979323846;

static double between(double low, double high, uint64_t stream, uint64_t index)
{
	return low + (high - low) * rb_random_unit(1, stream, index);
}

static rb_vec3 some_vector(uint64_t index)
{
	return rb_vec3_of(between(-2, 2, 10, index), between(-2, 2, 11, index),
	                  between(-2, 2, 12, index));
}

static rb_quat some_rotation(uint64_t index)
{
	return rb_quat_unit((rb_quat){between(-1, 1, 20, index), between(-1, 1, 21, index),
	                              between(-1, 1, 22, index), between(-1, 1, 23, index)});
}

static void assert_same_vector(rb_vec3 a, rb_vec3 b, double tol)
{
	assert_near(a.x, b.x, tol);
	assert_near(a.y, b.y, tol);
	assert_near(a.z, b.z, tol);
}

static void assert_same_matrix(const rb_mat3 *a, const rb_mat3 *b, double tol)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			assert_near(a->m[i][j], b->m[i][j], tol);
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

static void inverse_undoes_a_matrix_of_any_size(void **state)
{
	const rb_mat3 one = rb_mat3_diagonal(1, 1, 1);

	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const double size = ldexp(1, (int)(k % 5) * 200 - 400);
		rb_mat3 a, inverse;
		for (int i = 0; i < 9; i++)
			a.m[i / 3][i % 3] = size * (between(-1, 1, 30 + (uint64_t)i, k) +
			                            (i % 4 == 0 ? 4 : 0));
		assert_true(rb_mat3_inverse(&a, &inverse));
		const rb_mat3 product = rb_mat3_multiply(&a, &inverse);
		assert_same_matrix(&product, &one, 1e-15 * 8);
	}
}

static void a_singular_matrix_has_no_inverse(void **state)
{
	const rb_mat3 singular[] = {
		{{{0}}},
		{{{1, 2, 3}, {2, 4, 6}, {0, 0, 1}}},
		{{{(double)NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
		{{{(double)INFINITY, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
	};

	(void)state;
	for (size_t i = 0; i < sizeof singular / sizeof *singular; i++) {
		rb_mat3 inverse = rb_mat3_diagonal(7, 7, 7);
		const rb_mat3 zero = {{{0}}};
		assert_false(rb_mat3_inverse(&singular[i], &inverse));
		assert_same_matrix(&inverse, &zero, 0);
	}
}

static void transposed_products_agree(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 100; k++) {
		const rb_quat q = some_rotation(k);
		rb_mat3 a = rb_quat_to_mat3(q);
		a.m[0][1] += 1; /* no rotation any more */
		const rb_mat3 t = rb_mat3_transposed(&a);
		assert_same_vector(rb_mat3_apply(&t, some_vector(k)),
		                   rb_mat3_apply_transposed(&a, some_vector(k)), 1e-14);
	}
}

static void a_turn_of_a_quarter_about_z_takes_x_to_y(void **state)
{
	const rb_quat q = rb_quat_from_turn(rb_vec3_of(0, 0, pi / 2));

	(void)state;
	assert_same_vector(rb_quat_rotate(q, rb_vec3_of(1, 0, 0)), rb_vec3_of(0, 1, 0), 1e-15);
	assert_same_vector(rb_quat_rotate_back(q, rb_vec3_of(0, 1, 0)), rb_vec3_of(1, 0, 0), 1e-15);
}

static void the_matrix_of_a_quaternion_rotates_alike(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_quat q = some_rotation(k);
		const rb_mat3 r = rb_quat_to_mat3(q);
		assert_same_vector(rb_mat3_apply(&r, some_vector(k)),
		                   rb_quat_rotate(q, some_vector(k)), 1e-14);
	}
}

static void a_product_rotates_by_the_right_factor_first(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_quat a = some_rotation(k), b = some_rotation(k + 1000);
		assert_same_vector(rb_quat_rotate(rb_quat_multiply(a, b), some_vector(k)),
		                   rb_quat_rotate(a, rb_quat_rotate(b, some_vector(k))), 1e-14);
	}
}

static void a_quaternion_survives_its_matrix_in_every_branch(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 1000; k++) {
		rb_quat q = some_rotation(k);
		if (k % 5 == 1)
			q = rb_quat_unit((rb_quat){1e-9, 1, 0.1, 0});
		else if (k % 5 == 2)
			q = rb_quat_unit((rb_quat){0, 0.1, 1, 1e-9});
		else if (k % 5 == 3)
			q = (rb_quat){0, 0, 0, 1};
		const rb_mat3 r = rb_quat_to_mat3(q);
		const rb_quat p = rb_quat_from_mat3(&r);
		/* q and -q are the same rotation */
		const double sign = p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z < 0 ? -1 : 1;
		assert_near(sign * p.w, q.w, 1e-15 * 4);
		assert_near(sign * p.x, q.x, 1e-15 * 4);
		assert_near(sign * p.y, q.y, 1e-15 * 4);
		assert_near(sign * p.z, q.z, 1e-15 * 4);
	}
}

static void small_turns_join_large_ones_without_a_jump(void **state)
{
	(void)state;
	for (int e = -40; e <= 2; e++) {
		for (int side = 0; side < 3; side++) {
			const double angle = side == 0 ? ldexp(1, e)
			                               : 1e-4 * (side == 1 ? 1 - 1e-12 : 1 + 1e-12);
			const rb_quat q = rb_quat_from_turn(rb_vec3_of(0, angle, 0));
			assert_near(q.y / sin(angle / 2), 1, 4e-16);
			assert_near(rb_quat_length(q), 1, 4e-16);
		}
	}
	const rb_quat none = rb_quat_from_turn(rb_vec3_of(0, 0, 0));
	assert_near(none.w, 1, 0);
	assert_near(none.x, 0, 0);
}

static void columns_round_trip(void **state)
{
	double p[4];

	(void)state;
	rb_quat_to(p, (rb_quat){1, 2, 3, 4});
	const rb_quat q = rb_quat_from(p);
	assert_true(p[0] == 1 && p[3] == 4 && q.w == 1 && q.x == 2 && q.y == 3 && q.z == 4);
	rb_vec3_to(p, rb_vec3_of(5, 6, 7));
	assert_same_vector(rb_vec3_from(p), rb_vec3_of(5, 6, 7), 0);
}

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

static void the_length_of_what_is_no_number_is_none(void **slot)
{
	(void)slot;
	assert_true(isnan(rb_vec3_length((rb_vec3){(double)NAN, 0, 0})));
	assert_true(isnan(rb_vec3_length((rb_vec3){0, 1e300, (double)NAN})));
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
		cmocka_unit_test(inverse_undoes_a_matrix_of_any_size),
		cmocka_unit_test(a_singular_matrix_has_no_inverse),
		cmocka_unit_test(transposed_products_agree),
		cmocka_unit_test(a_turn_of_a_quarter_about_z_takes_x_to_y),
		cmocka_unit_test(the_matrix_of_a_quaternion_rotates_alike),
		cmocka_unit_test(a_product_rotates_by_the_right_factor_first),
		cmocka_unit_test(a_quaternion_survives_its_matrix_in_every_branch),
		cmocka_unit_test(small_turns_join_large_ones_without_a_jump),
		cmocka_unit_test(columns_round_trip),
		cmocka_unit_test(random_numbers_are_uniform_and_streams_do_not_resemble_each_other),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
