/* SPDX-License-Identifier: MIT */
/* src/shape/box.c */
#include "slices.h"

static const struct rb_shape_type *const row = &rb_shape_box;
static const struct rb_shape brick = {.kind = RB_SHAPE_BOX, .size = {0.6, 1, 2.4}};

/* By cells: the midpoint rule is off by (cell / size)^2 of a moment. */
static void mass_and_moments_are_those_of_its_cells(void **state)
{
	enum { CELLS = 60 };
	const double mass = 5, each = mass / (CELLS * CELLS * CELLS);
	double xx = 0, yy = 0, zz = 0;

	(void)state;
	for (int k = 0; k < CELLS * CELLS * CELLS; k++) {
		const double x = 0.6 * ((k % CELLS + 0.5) / CELLS - 0.5);
		const double y = 1 * ((k / CELLS % CELLS + 0.5) / CELLS - 0.5);
		const double z = 2.4 * ((k / CELLS / CELLS + 0.5) / CELLS - 0.5);

		xx += each * (y * y + z * z);
		yy += each * (x * x + z * z);
		zz += each * (x * x + y * y);
	}
	const rb_mat3 inertia = row->inertia(&brick, mass);
	const double bound = 1.1 / (CELLS * CELLS);
	assert_near(inertia.m[0][0] / xx, 1, bound);
	assert_near(inertia.m[1][1] / yy, 1, bound);
	assert_near(inertia.m[2][2] / zz, 1, bound);
	assert_near(row->volume(&brick), 0.6 * 1 * 2.4, 1e-15);
}

static void faces_are_so_far_along_their_normals(void **state)
{
	const double half[] = {0.3, 0.5, 1.2};

	(void)state;
	for (int k = 0; k < 60; k++) {
		const int axis = k % 3;
		const double sign = k % 2 ? 1 : -1;
		double p[3], n[3] = {0, 0, 0};

		/* the others well within the face, so that it is the nearest of all */
		for (int i = 0; i < 3; i++)
			p[i] = 0.9 * half[i] * sin(k + 3 * i);
		p[axis] = sign * half[axis];
		n[axis] = sign;
		slices_assert_surface(row, &brick, rb_vec3_from(p), rb_vec3_from(n));
		assert_near(slices_support(row, &brick, rb_vec3_from(n)), half[axis], 1e-15);
	}
	assert_near(row->distance(&brick, rb_vec3_of(0, 0, 0)), -0.3, 0);
}

static void beyond_edges_and_corners_the_distance_is_theirs(void **state)
{
	(void)state;
	assert_near(row->distance(&brick, rb_vec3_of(0.3 + 3, 0.5 + 4, 1)), 5, 1e-14);
	assert_near(row->distance(&brick, rb_vec3_of(-0.3 - 2, 0.5 + 3, -1.2 - 6)), 7, 1e-14);
	assert_near(row->reach(&brick), sqrt(0.3 * 0.3 + 0.5 * 0.5 + 1.2 * 1.2), 1e-15);
}

static void its_half_width_is_half_of_the_shortest_edge(void **state)
{
	struct rb_shape shape = brick;

	(void)state;
	for (int i = 0; i < 3; i++) {
		shape = brick;
		shape.size[i] = 0.25;
		assert_near(row->half_width(&shape), 0.125, 0);
	}
}

static void its_sizes_must_be_positive_and_finite(void **state)
{
	struct rb_shape shape = brick;
	double *const number[] = {&shape.size[0], &shape.size[1], &shape.size[2]};

	(void)state;
	slices_assert_faults(row, &brick, number, 3, &shape);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(mass_and_moments_are_those_of_its_cells),
		cmocka_unit_test(faces_are_so_far_along_their_normals),
		cmocka_unit_test(beyond_edges_and_corners_the_distance_is_theirs),
		cmocka_unit_test(its_half_width_is_half_of_the_shortest_edge),
		cmocka_unit_test(its_sizes_must_be_positive_and_finite),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
