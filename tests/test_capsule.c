/* SPDX-License-Identifier: MIT */
/* src/shape/capsule.c */
#include "slices.h"

static const struct rb_shape_type *const row = &rb_shape_capsule;
static const struct rb_shape pill = {.kind = RB_SHAPE_CAPSULE, .radius = 0.6, .size = {0, 0, 1.8}};

static double radius_at(const struct rb_shape *shape, double z)
{
	const double beyond = fmax(0, fabs(z) - 0.5 * shape->size[2]);

	return sqrt(fmax(0, shape->radius * shape->radius - beyond * beyond));
}

static void mass_and_moments_are_those_of_its_slices(void **state)
{
	(void)state;
	slices_assert(row, &pill, radius_at, 1.5);
}

/* A short one is nearly a ball, a long one nearly a cylinder. */
static void moments_join_those_of_balls_and_cylinders(void **state)
{
	struct rb_shape shape = pill;

	(void)state;
	shape.size[2] = 1e-9;
	const rb_mat3 ball = rb_shape_sphere.inertia(&shape, 2), near = row->inertia(&shape, 2);
	assert_near(near.m[0][0] / ball.m[0][0], 1, 1e-8);
	assert_near(near.m[2][2] / ball.m[2][2], 1, 1e-8);
	shape.size[2] = 1e9;
	const rb_mat3 drum = rb_shape_cylinder.inertia(&shape, 2), far = row->inertia(&shape, 2);
	assert_near(far.m[0][0] / drum.m[0][0], 1, 1e-8);
	assert_near(far.m[2][2] / drum.m[2][2], 1, 1e-8);
}

static void its_surface_is_a_radius_from_its_segment(void **state)
{
	(void)state;
	for (int k = 0; k < 100; k++) {
		const rb_vec3 n = rb_vec3_unit(rb_vec3_of(sin(k), cos(2 * k), sin(3 * k + 1)),
		                               rb_vec3_of(1, 0, 0));
		const double end = n.z < 0 ? -0.9 : 0.9;

		slices_assert_surface(row, &pill, rb_vec3_add_scaled(rb_vec3_of(0, 0, end), 0.6, n),
		                      n);
		const rb_vec3 side = {cos(k), sin(k), 0};
		slices_assert_surface(
			row, &pill,
			rb_vec3_add_scaled(rb_vec3_of(0, 0, 0.9 * sin(5 * k)), 0.6, side), side);
		assert_near(slices_support(row, &pill, n), 0.6 + 0.9 * fabs(n.z), 1e-15);
	}
	assert_near(row->distance(&pill, rb_vec3_of(0, 0, 0.5)), -0.6, 1e-15);
	assert_near(row->reach(&pill), 1.5, 0);
	assert_near(row->half_width(&pill), 0.6, 0);
}

static void its_numbers_must_be_positive_and_finite(void **state)
{
	struct rb_shape shape = pill;
	double *const number[] = {&shape.radius, &shape.size[2]};

	(void)state;
	slices_assert_faults(row, &pill, number, 2, &shape);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(mass_and_moments_are_those_of_its_slices),
		cmocka_unit_test(moments_join_those_of_balls_and_cylinders),
		cmocka_unit_test(its_surface_is_a_radius_from_its_segment),
		cmocka_unit_test(its_numbers_must_be_positive_and_finite),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
