/* SPDX-License-Identifier: MIT */
/* src/math/mat3.h */
#include "turns.h"

#include "math/mat3.h"

static void assert_same_matrix(const rb_mat3 *a, const rb_mat3 *b, double tol)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			assert_near(a->m[i][j], b->m[i][j], tol);
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

static void a_product_applies_the_right_factor_first(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 100; k++) {
		rb_mat3 a, b;
		const rb_vec3 v = some_vector(k);

		for (int i = 0; i < 9; i++) {
			a.m[i / 3][i % 3] = between(-1, 1, 40 + (uint64_t)i, k);
			b.m[i / 3][i % 3] = between(-1, 1, 50 + (uint64_t)i, k);
		}
		const rb_mat3 product = rb_mat3_multiply(&a, &b);
		assert_same_vector(rb_mat3_apply(&product, v),
		                   rb_mat3_apply(&a, rb_mat3_apply(&b, v)), 1e-14);
		/* (AB)' = B'A' */
		const rb_mat3 at = rb_mat3_transposed(&a), bt = rb_mat3_transposed(&b);
		const rb_mat3 turned = rb_mat3_transposed(&product),
			      swapped = rb_mat3_multiply(&bt, &at);
		assert_same_matrix(&turned, &swapped, 1e-15);
	}
}

static void a_diagonal_scales_each_coordinate(void **state)
{
	const rb_mat3 d = rb_mat3_diagonal(2, -3, 0.5);

	(void)state;
	assert_same_vector(rb_mat3_apply(&d, rb_vec3_of(1, 10, 100)), rb_vec3_of(2, -30, 50), 0);
	assert_same_vector(rb_mat3_apply_transposed(&d, rb_vec3_of(1, 10, 100)),
	                   rb_vec3_of(2, -30, 50), 0);
}

/* Where the inverse has a closed form: rotations, whose inverse is the transpose. */
static void the_inverse_of_a_rotation_is_its_transpose(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 100; k++) {
		const rb_mat3 r = rb_quat_to_mat3(some_rotation(k)), t = rb_mat3_transposed(&r);
		rb_mat3 inverse;

		assert_true(rb_mat3_inverse(&r, &inverse));
		assert_same_matrix(&inverse, &t, 4e-15);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(inverse_undoes_a_matrix_of_any_size),
		cmocka_unit_test(a_singular_matrix_has_no_inverse),
		cmocka_unit_test(transposed_products_agree),
		cmocka_unit_test(a_product_applies_the_right_factor_first),
		cmocka_unit_test(a_diagonal_scales_each_coordinate),
		cmocka_unit_test(the_inverse_of_a_rotation_is_its_transpose),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
