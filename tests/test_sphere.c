/* SPDX-License-Identifier: MIT */
/* src/shape/sphere.c */
#include "slices.h"

static const struct rb_shape_type *const row = &rb_shape_sphere;
static const struct rb_shape ball = {.kind = RB_SHAPE_SPHERE, .radius = 0.7};

static double radius_at(const struct rb_shape *shape, double z)
{
	return sqrt(fmax(0, shape->radius * shape->radius - z * z));
}

static void mass_and_moments_are_those_of_its_slices(void **state)
{
	(void)state;
	slices_assert(row, &ball, radius_at, ball.radius);
}

static void every_point_of_its_surface_is_a_radius_away(void **state)
{
	(void)state;
	for (int k = 0; k < 100; k++) {
		const rb_vec3 n = rb_vec3_unit(rb_vec3_of(sin(k), cos(2 * k), sin(3 * k + 1)),
		                               rb_vec3_of(1, 0, 0));

		slices_assert_surface(row, &ball, rb_vec3_scale(ball.radius, n), n);
		assert_near(slices_support(row, &ball, n), ball.radius, 1e-15);
	}
	assert_near(row->distance(&ball, rb_vec3_of(0, 0, 0)), -ball.radius, 0);
	assert_near(row->half_width(&ball), ball.radius, 0);
}

static void a_radius_must_be_positive_and_finite(void **state)
{
	struct rb_shape shape = ball;
	double *const number[] = {&shape.radius};

	(void)state;
	slices_assert_faults(row, &ball, number, 1, &shape);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(mass_and_moments_are_those_of_its_slices),
		cmocka_unit_test(every_point_of_its_surface_is_a_radius_away),
		cmocka_unit_test(a_radius_must_be_positive_and_finite),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
