/* SPDX-License-Identifier: MIT */
/* src/shape/cylinder.c */
#include "slices.h"

static const struct rb_shape_type *const row = &rb_shape_cylinder;
static const struct rb_shape drum = {.kind = RB_SHAPE_CYLINDER, .radius = 0.7, .size = {0, 0, 2.2}};

static double radius_at(const struct rb_shape *shape, double z)
{
	(void)z;
	return shape->radius;
}

static void mass_and_moments_are_those_of_its_slices(void **state)
{
	(void)state;
	slices_assert(row, &drum, radius_at, 1.1);
}

static void mantle_and_ends_are_so_far_along_their_normals(void **state)
{
	(void)state;
	for (int k = 0; k < 50; k++) {
		const rb_vec3 n = {cos(k), sin(k), 0};
		const double z = 1.05 * sin(7 * k), in = 0.65 * fabs(cos(5 * k));

		slices_assert_surface(row, &drum, rb_vec3_of(0.7 * n.x, 0.7 * n.y, z), n);
		slices_assert_surface(row, &drum, rb_vec3_of(in * n.x, in * n.y, 1.1),
		                      rb_vec3_of(0, 0, 1));
		slices_assert_surface(row, &drum, rb_vec3_of(in * n.x, in * n.y, -1.1),
		                      rb_vec3_of(0, 0, -1));
	}
}

/* Off a rim the nearest point is on it. */
static void beyond_a_rim_the_distance_is_that_to_the_rim(void **state)
{
	(void)state;
	for (int k = 0; k < 50; k++) {
		const double out = 0.01 * (k + 1), up = 0.5 - 0.009 * k;

		assert_near(row->distance(&drum, rb_vec3_of((0.7 + out) * cos(k),
		                                            (0.7 + out) * sin(k), 1.1 + up)),
		            hypot(out, up), 1e-14);
	}
	assert_near(row->distance(&drum, rb_vec3_of(0, 0, 0)), -0.7, 1e-15);
}

/* r sin + h/2 |cos| of the angle to the axis. */
static void its_core_reaches_to_its_rim(void **state)
{
	(void)state;
	for (int k = 0; k < 50; k++) {
		const double angle = 0.1 * k;
		const rb_vec3 n = {sin(angle) * cos(k), sin(angle) * sin(k), cos(angle)};

		assert_near(slices_support(row, &drum, n),
		            0.7 * fabs(sin(angle)) + 1.1 * fabs(cos(angle)), 1e-15);
	}
	assert_near(row->reach(&drum), sqrt(0.7 * 0.7 + 1.1 * 1.1), 1e-15);
}

static void its_half_width_is_the_smaller_of_radius_and_half_length(void **state)
{
	struct rb_shape shape = drum;

	(void)state;
	assert_near(row->half_width(&shape), 0.7, 0);
	shape.size[2] = 0.5;
	assert_near(row->half_width(&shape), 0.25, 0);
}

static void its_numbers_must_be_positive_and_finite(void **state)
{
	struct rb_shape shape = drum;
	double *const number[] = {&shape.radius, &shape.size[2]};

	(void)state;
	slices_assert_faults(row, &drum, number, 2, &shape);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(mass_and_moments_are_those_of_its_slices),
		cmocka_unit_test(mantle_and_ends_are_so_far_along_their_normals),
		cmocka_unit_test(beyond_a_rim_the_distance_is_that_to_the_rim),
		cmocka_unit_test(its_core_reaches_to_its_rim),
		cmocka_unit_test(its_half_width_is_the_smaller_of_radius_and_half_length),
		cmocka_unit_test(its_numbers_must_be_positive_and_finite),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
