/* SPDX-License-Identifier: MIT */
/* src/geom/separation.c: the normal and signed gap of two convex cores */
#include "shapes.h"

#include "geom/separation.h"

/* Boxes along the axes: apart their distance, overlapping the least that would part them. */
static double boxes_gap(rb_vec3 d, rb_vec3 half)
{
	const double x = fabs(d.x) - half.x, y = fabs(d.y) - half.y, z = fabs(d.z) - half.z;

	if (x <= 0 && y <= 0 && z <= 0)
		return fmax(x, fmax(y, z));
	return sqrt(pow(fmax(x, 0), 2) + pow(fmax(y, 0), 2) + pow(fmax(z, 0), 2));
}

static void boxes_have_the_gap_of_their_closed_form_in_any_frame(void **state)
{
	shape p = shapes_box(1, 0.5, 2), q = shapes_box(0.3, 1, 0.2);
	int apart = 0, together = 0;

	(void)state;
	for (uint64_t k = 0; k < 500; k++) {
		const rb_vec3 d = shapes_vector(5, k, 3.5);
		const rb_mat3 turn = shapes_turn(6, k);
		const rb_placed a = {&p.core, {0, 0, 0}, turn};
		const rb_placed b = {&q.core, rb_mat3_apply(&turn, d), turn};
		const double wanted = boxes_gap(d, (rb_vec3){1.3, 1.5, 2.2});
		const rb_separation found = rb_separation_of(&a, &b);

		assert_near(found.gap, wanted, 1e-13);
		assert_near(rb_vec3_length(found.normal), 1, 1e-14);
		assert_true(found.noise > 0 && found.noise < 1e-13);
		/* its normal proves it */
		assert_near(rb_vec3_dot(found.normal, b.at) - rb_placed_height(&a, found.normal) -
		                    rb_placed_height(&b, rb_vec3_neg(found.normal)),
		            found.gap, found.noise);
		apart += wanted > 0;
		together += wanted < 0;
	}
	assert_true(apart > 100 && together > 30);
	rb_polytope_destroy(p.polytope);
	rb_polytope_destroy(q.polytope);
}

/* Boxes on their edges, one along x and one across it: as far as the edges, whose ends are far away. */
static void edges_that_cross_have_the_gap_of_their_lines(void **state)
{
	shape p = shapes_box(3, 0.5, 0.5), q = shapes_box(0.5, 3, 0.5);
	const double pi = 3.14159265358979323846;

	(void)state;
	for (uint64_t k = 0; k < 100; k++) {
		const double z = 1.2 + shapes_random(7, k);
		const rb_placed a = {&p.core, {0, 0, 0}, shapes_turned((rb_vec3){pi / 4, 0, 0})};
		const rb_placed b = {&q.core,
		                     {2 * shapes_random(8, k) - 1, 2 * shapes_random(9, k) - 1, z},
		                     shapes_turned((rb_vec3){0, pi / 4, 0})};
		const rb_separation found = rb_separation_of(&a, &b);

		assert_near(found.gap, z - sqrt(2), 1e-14);
		assert_near(found.normal.z, 1, 1e-14);
	}
	rb_polytope_destroy(p.polytope);
	rb_polytope_destroy(q.polytope);
}

static void a_core_over_a_half_space_is_as_high_as_its_lowest_point(void **state)
{
	const rb_core ground = rb_core_of_half_space(), drum = rb_core_of_cylinder(0.4, 1);

	(void)state;
	for (uint64_t k = 0; k < 100; k++) {
		const rb_placed a = {
			&drum, {0.1, -0.2, 4 * shapes_random(8, k) - 1}, shapes_turn(9, k)};
		const rb_placed b = {&ground, {0, 0, 0}, shapes_upright};
		const double lowest = a.at.z - rb_placed_height(&a, (rb_vec3){0, 0, -1});
		const rb_separation found = rb_separation_of(&a, &b);

		assert_near(found.gap, lowest, 1e-14);
		assert_near(found.normal.z, -1, 0); /* from the drum to the ground */
	}
}

static void the_other_way_round_the_gap_is_the_same_and_the_normal_opposite(void **state)
{
	const rb_core drum = rb_core_of_cylinder(0.4, 1);
	shape q = shapes_box(0.3, 1, 0.2);

	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_vec3 d = shapes_vector(3, k, 2);
		const rb_placed a = {&drum, {0, 0, 0}, shapes_turn(1, k)};
		const rb_placed b = {&q.core, d, shapes_turn(2, k)};
		const rb_separation one = rb_separation_of(&a, &b),
				    other = rb_separation_of(&b, &a);

		/* families of directions are found by Newton's method, to some ulp of the sizes */
		assert_near(one.gap, other.gap, 1e-12);
		/* where the normal is one: not deep inside, where several may be best */
		if (one.gap > 1e-3)
			assert_near(rb_vec3_dot(one.normal, other.normal), -1, 1e-9);
	}
	rb_polytope_destroy(q.polytope);
}

static void beyond_a_limit_is_never_more_than_the_gap(void **state)
{
	shape p = shapes_box(1, 0.5, 2);
	int seen = 0;

	(void)state;
	for (uint64_t k = 0; k < 300; k++) {
		const rb_placed a = {&p.core, {0, 0, 0}, shapes_turn(1, k)};
		const rb_placed b = {&p.core, shapes_vector(4, k, 5), shapes_turn(2, k)};
		const rb_separation whole = rb_separation_of(&a, &b);
		rb_vec3 axis = {0, 0, 0};
		const double found = rb_separation_beyond(&a, &b, 0.1, 12, &axis);

		if (isinf(found)) {
			assert_true(found < 0);
			continue;
		}
		seen++;
		assert_true(found > 0.1 && found <= whole.gap);
		/* with the axis it has left, one direction tells them apart again */
		assert_true(rb_separation_beyond(&a, &b, 0.1, 1, &axis) > 0.1);
	}
	assert_true(seen > 100);
	rb_polytope_destroy(p.polytope);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(boxes_have_the_gap_of_their_closed_form_in_any_frame),
		cmocka_unit_test(edges_that_cross_have_the_gap_of_their_lines),
		cmocka_unit_test(a_core_over_a_half_space_is_as_high_as_its_lowest_point),
		cmocka_unit_test(the_other_way_round_the_gap_is_the_same_and_the_normal_opposite),
		cmocka_unit_test(beyond_a_limit_is_never_more_than_the_gap),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
