/* SPDX-License-Identifier: MIT */
/* src/geom/core.c: how far convex cores reach */
#include "shapes.h"

#include "geom/core.h"

/* Cores of every kind that ends, and the body's own points that they are the hull of (rims by their corners). */
enum { POINTS_MAX = 4000 };

static int points_of(const rb_core *core, rb_vec3 point[POINTS_MAX])
{
	int count = 0;

	if (core->kind == RB_CORE_POLYTOPE) {
		for (; count < core->polytope->vertex_count; count++)
			point[count] = core->polytope->vertices[count];
		return count;
	}
	for (; count < POINTS_MAX; count++) {
		const double angle = 4 * 3.14159265358979323846 * (count / 2) / POINTS_MAX;

		point[count] = (rb_vec3){core->round * cos(angle), core->round * sin(angle),
		                         count % 2 ? core->half_height : -core->half_height};
	}
	return count;
}

static rb_vec3 point[POINTS_MAX];

static void a_core_reaches_as_far_as_its_farthest_point(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 300; k++) {
		shape s = {NULL, rb_core_of_cylinder(0.4, 1.1)};

		if (k % 3 > 0)
			s = shapes_box(0.2, 0.7, (double)(k % 3));
		const rb_placed placed = {&s.core, shapes_vector(1, k, 3), shapes_turn(2, k)};
		const rb_vec3 n = rb_vec3_unit(shapes_vector(3, k, 1), (rb_vec3){1, 0, 0});
		const int count = points_of(&s.core, point);
		double far = -(double)INFINITY;

		for (int i = 0; i < count; i++)
			far = fmax(far, rb_vec3_dot(n, rb_mat3_apply(&placed.turn, point[i])));
		/* a rim by its corners: short by r (1 - cos(pi / corners of a rim)) */
		const double bound = k % 3 > 0 ? 1e-15 : 0.4 * 5 / pow(POINTS_MAX / 2.0, 2) + 1e-15;
		const double height = rb_placed_height(&placed, n);
		assert_true(height >= far - 1e-15 && height <= far + bound);
		/* a point of it that has that height, where it is */
		const rb_vec3 support = rb_placed_support(&placed, n);
		assert_near(rb_vec3_dot(n, rb_vec3_sub(support, placed.at)), height, 2e-15);
		assert_true(rb_vec3_length(rb_vec3_sub(support, placed.at)) <=
		            s.core.reach * (1 + 1e-15));
		rb_polytope_destroy(s.polytope);
	}
}

/* Turned to an axis, so that no rounding tilts it. */
static void a_half_space_ends_along_its_normal_alone(void **state)
{
	static const rb_mat3 turns[] = {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
	                                {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}},
	                                {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}}};
	const rb_core core = rb_core_of_half_space();

	(void)state;
	for (uint64_t k = 0; k < 3; k++) {
		const rb_placed placed = {&core, shapes_vector(1, k, 3), turns[k]};
		const rb_vec3 n = rb_placed_axis(&placed);

		assert_near(rb_placed_height(&placed, n), 0, 0);
		assert_true(isinf(rb_placed_height(&placed, rb_vec3_neg(n))));
		assert_true(isinf(rb_placed_height(&placed, rb_vec3_across(n))));
		assert_true(isinf(
			rb_placed_height(&placed, rb_vec3_add_scaled(n, 1e-9, rb_vec3_across(n)))));
	}
}

static void the_axis_is_where_the_bodys_z_points(void **state)
{
	const rb_core core = rb_core_of_cylinder(1, 2);

	(void)state;
	for (uint64_t k = 0; k < 50; k++) {
		const rb_placed placed = {&core, shapes_vector(1, k, 3), shapes_turn(2, k)};
		const rb_vec3 end = rb_placed_point(&placed, (rb_vec3){0, 0, 2});
		const rb_vec3 wanted = rb_vec3_add_scaled(placed.at, 2, rb_placed_axis(&placed));

		assert_near(rb_vec3_length(rb_vec3_sub(end, wanted)), 0, 2e-15);
	}
}

static void the_reach_is_that_of_the_farthest_corner_or_rim(void **state)
{
	shape s = shapes_box(3, 4, 12);

	(void)state;
	assert_near(s.core.reach, 13, 1e-14);
	rb_polytope_destroy(s.polytope);
	assert_near(rb_core_of_cylinder(3, 4).reach, 5, 1e-15);
	assert_near(rb_core_of_cylinder(3, 4).radius, 0, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_core_reaches_as_far_as_its_farthest_point),
		cmocka_unit_test(a_half_space_ends_along_its_normal_alone),
		cmocka_unit_test(the_axis_is_where_the_bodys_z_points),
		cmocka_unit_test(the_reach_is_that_of_the_farthest_corner_or_rim),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
