/* SPDX-License-Identifier: MIT */
/* src/geom/mass.c */
#include "support.h"

#include "geom/mass.h"
#include "math/quat.h"

static void a_sphere_has_the_volume_and_inertia_of_the_books(void **slot)
{
	const struct rb_shape ball = {.kind = RB_SHAPE_SPHERE, .radius = 2};

	(void)slot;
	assert_near(rb_shape_volume(&ball), 33.510321638291124, 1e-14);
	const rb_mat3 inertia = rb_shape_inertia(&ball, 5);
	for (int i = 0; i < 9; i++)
		assert_near(inertia.m[i / 3][i % 3], i % 4 == 0 ? 8 : 0, 1e-15);
	assert_true(rb_inertia_is_scalar(&inertia));
}

static void a_plane_has_no_volume_and_no_inertia(void **slot)
{
	const struct rb_shape sheet = {.kind = RB_SHAPE_RECTANGLE, .size = {1, 2}};

	(void)slot;
	assert_near(rb_shape_volume(&sheet), 0, 0);
	assert_near(rb_shape_inertia(&sheet, 1).m[0][0], 0, 0);
}

static rb_mat3 turned(double x, double y, double z, rb_vec3 turn)
{
	const rb_mat3 r = rb_quat_to_mat3(rb_quat_from_turn(turn)), d = rb_mat3_diagonal(x, y, z);
	const rb_mat3 back = rb_mat3_transposed(&r), rd = rb_mat3_multiply(&r, &d);

	return rb_mat3_multiply(&rd, &back);
}

static void principal_moments_do_not_depend_on_how_the_axes_stand(void **slot)
{
	(void)slot;
	for (int k = 0; k < 20; k++) {
		const rb_mat3 inertia = turned(3e-9, 1e-9, 2.5e-9,
		                               (rb_vec3){0.3 * k, 1 - 0.1 * k, 0.7});
		double moments[3];

		rb_inertia_principal(&inertia, moments);
		assert_near(moments[0], 1e-9, 1e-23);
		assert_near(moments[1], 2.5e-9, 1e-23);
		assert_near(moments[2], 3e-9, 1e-23);
		assert_null(rb_inertia_fault(&inertia));
		assert_false(rb_inertia_is_scalar(&inertia));
	}
}

static void a_flat_body_is_possible_and_anything_beyond_is_not(void **slot)
{
	const rb_mat3 flat = turned(1, 2, 3, (rb_vec3){0.5, 0.6, 0.7});
	const rb_mat3 beyond = turned(1, 2, 3.01, (rb_vec3){0.5, 0.6, 0.7});

	(void)slot;
	assert_null(rb_inertia_fault(&flat));
	assert_non_null(strstr(rb_inertia_fault(&beyond), "above the sum"));
}

static void a_tensor_that_is_lopsided_negative_or_not_finite_is_refused(void **slot)
{
	rb_mat3 inertia = rb_mat3_diagonal(1, 1, 1);

	(void)slot;
	inertia.m[0][1] = 0.1;
	assert_non_null(strstr(rb_inertia_fault(&inertia), "symmetric"));
	inertia = rb_mat3_diagonal(1, 1, -1);
	assert_non_null(strstr(rb_inertia_fault(&inertia), "positive"));
	inertia = rb_mat3_diagonal(0, 0, 0);
	assert_non_null(strstr(rb_inertia_fault(&inertia), "positive"));
	inertia = rb_mat3_diagonal(1, (double)NAN, 1);
	assert_non_null(strstr(rb_inertia_fault(&inertia), "finite"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sphere_has_the_volume_and_inertia_of_the_books),
		cmocka_unit_test(a_plane_has_no_volume_and_no_inertia),
		cmocka_unit_test(principal_moments_do_not_depend_on_how_the_axes_stand),
		cmocka_unit_test(a_flat_body_is_possible_and_anything_beyond_is_not),
		cmocka_unit_test(a_tensor_that_is_lopsided_negative_or_not_finite_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
