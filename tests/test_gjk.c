/* SPDX-License-Identifier: MIT */
/* src/geom/gjk.c: how far two cores are apart, from both sides */
#include "shapes.h"

#include "geom/gjk.h"

/* Boxes along the axes: the distance has a closed form. */
static double boxes_apart(rb_vec3 d, rb_vec3 half)
{
	const double x = fmax(0, fabs(d.x) - half.x), y = fmax(0, fabs(d.y) - half.y),
		     z = fmax(0, fabs(d.z) - half.z);

	return sqrt(x * x + y * y + z * z);
}

static void the_distance_of_boxes_lies_between_both_bounds(void **state)
{
	shape p = shapes_box(1, 0.5, 2), q = shapes_box(0.3, 1, 0.2);
	int apart = 0, together = 0;

	(void)state;
	for (uint64_t k = 0; k < 800; k++) {
		const rb_vec3 d = shapes_vector(5, k, 4);
		const rb_placed a = {&p.core, {0, 0, 0}, shapes_upright};
		const rb_placed b = {&q.core, d, shapes_upright};
		const double wanted = boxes_apart(d, (rb_vec3){1.3, 1.5, 2.2});
		const rb_gjk found = rb_gjk_run(&a, &b, 8, 0);

		if (found.is_separate) {
			assert_true(found.least <= wanted + 1e-13 && wanted <= found.upper + 1e-13);
			assert_near(found.upper, found.least, 1e-12);
			assert_near(rb_vec3_length(found.normal), 1, 1e-14);
			/* the direction proves it */
			const double proved = rb_vec3_dot(found.normal, d) -
			                      rb_placed_height(&a, found.normal) -
			                      rb_placed_height(&b, rb_vec3_neg(found.normal));
			assert_near(proved, wanted, 1e-12);
		}
		apart += wanted > 1e-9;
		together += wanted == 0;
		assert_int_equal(found.is_separate, wanted > 0);
	}
	assert_true(apart > 100 && together > 30);
	rb_polytope_destroy(p.polytope);
	rb_polytope_destroy(q.polytope);
}

/* Coaxial or side by side, a cylinder and a box have closed forms, too; a turn of both changes nothing. */
static void a_cylinder_over_a_box_is_as_far_as_it_is_high(void **state)
{
	const rb_core drum = rb_core_of_cylinder(0.5, 0.7);
	shape q = shapes_box(2, 2, 0.3);

	(void)state;
	for (uint64_t k = 0; k < 60; k++) {
		const rb_mat3 turn = shapes_turn(6, k);
		const double gap = 0.01 + 0.05 * (double)k;
		const rb_placed a = {&q.core, {0, 0, 0}, turn};
		const rb_placed b = {&drum, rb_mat3_apply(&turn, (rb_vec3){0.2, -0.4, 1 + gap}),
		                     turn};
		const rb_gjk found = rb_gjk_run(&a, &b, 6, 0);

		assert_true(found.is_separate);
		assert_true(found.least <= gap + 1e-13 && gap <= found.upper + 1e-13);
		assert_near(found.least, gap, 1e-10);
		assert_near(rb_vec3_dot(found.normal, rb_placed_axis(&a)), 1, 1e-9);
	}
	rb_polytope_destroy(q.polytope);
}

/* Two digits of a distance take a round core a third of the rounds of all of them, and bound it, too. */
static void a_coarse_distance_takes_few_rounds(void **state)
{
	const rb_core drum = rb_core_of_cylinder(0.5, 0.7);
	shape q = shapes_box(1, 0.5, 0.3);
	int coarse = 0, fine = 0;

	(void)state;
	for (uint64_t k = 0; k < 400; k++) {
		const rb_placed a = {&q.core, {0, 0, 0}, shapes_turn(6, k)};
		const rb_placed b = {&drum, shapes_vector(7, k, 3), shapes_turn(8, k)};
		const rb_gjk all = rb_gjk_run(&a, &b, 6, 0), some = rb_gjk_run(&a, &b, 6, 1e-3);

		if (!all.is_separate || all.upper < 1e-2)
			continue;
		assert_true(some.is_separate);
		assert_true(some.least <= all.upper + 1e-13 && all.least <= some.upper + 1e-13);
		assert_true(some.upper - some.least <= some.upper / 64);
		coarse += some.rounds;
		fine += all.rounds;
	}
	assert_true(fine > 1000 && 3 * coarse < fine);
	rb_polytope_destroy(q.polytope);
}

static void beyond_a_limit_is_what_a_direction_proves_or_nothing(void **state)
{
	shape p = shapes_box(1, 1, 1);

	(void)state;
	for (uint64_t k = 0; k < 200; k++) {
		const rb_vec3 d = shapes_vector(7, k, 5);
		const rb_placed a = {&p.core, {0, 0, 0}, shapes_upright};
		const rb_placed b = {&p.core, d, shapes_upright};
		const double wanted = boxes_apart(d, (rb_vec3){2, 2, 2});
		rb_vec3 axis = {0, 0, 0};
		const double limit = 0.5, found = rb_gjk_beyond(&a, &b, limit, 12, &axis);

		if (isinf(found)) {
			/* twelve directions see all that is not close to the limit */
			assert_true(found < 0 && wanted < limit * 1.2);
			continue;
		}
		assert_true(found > limit && found <= wanted + 1e-12);
		assert_near(rb_vec3_length(axis), 1, 1e-14);
		/* with what it has left, one round is enough */
		const double again = rb_gjk_beyond(&a, &b, limit, 1, &axis);
		assert_true(again > limit && again <= wanted + 1e-12);
	}
	rb_polytope_destroy(p.polytope);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_distance_of_boxes_lies_between_both_bounds),
		cmocka_unit_test(a_cylinder_over_a_box_is_as_far_as_it_is_high),
		cmocka_unit_test(a_coarse_distance_takes_few_rounds),
		cmocka_unit_test(beyond_a_limit_is_what_a_direction_proves_or_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
