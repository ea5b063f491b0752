/* SPDX-License-Identifier: MIT */
/* src/geom/axis_test.h: what one direction proves of a gap */
#include "shapes.h"

#include "geom/axis_test.h"

/* Two boxes along the axes: what a direction along one proves is the gap of their intervals. */
static void a_direction_proves_the_gap_of_the_intervals(void **state)
{
	shape p = shapes_box(1, 2, 3), q = shapes_box(0.5, 0.25, 0.125);

	(void)state;
	for (uint64_t k = 0; k < 50; k++) {
		const rb_placed a = {&p.core, shapes_vector(1, k, 4), shapes_upright};
		const rb_placed b = {&q.core, shapes_vector(2, k, 4), shapes_upright};
		const rb_axis axis = {.a = &a, .b = &b};
		const double x = b.at.x - a.at.x, y = b.at.y - a.at.y, z = b.at.z - a.at.z;

		assert_near(rb_axis_gap(&axis, (rb_vec3){1, 0, 0}), x - 1.5, 4e-15);
		assert_near(rb_axis_gap(&axis, (rb_vec3){-1, 0, 0}), -x - 1.5, 4e-15);
		assert_near(rb_axis_gap(&axis, (rb_vec3){0, 1, 0}), y - 2.25, 4e-15);
		assert_near(rb_axis_gap(&axis, (rb_vec3){0, 0, -1}), -z - 3.125, 4e-15);
	}
	rb_polytope_destroy(p.polytope);
	rb_polytope_destroy(q.polytope);
}

static void the_best_stays_unless_it_is_beaten_by_more_than_rounding(void **state)
{
	shape p = shapes_box(1, 1, 1);

	(void)state;
	const rb_placed a = {&p.core, {0, 0, 0}, shapes_upright};
	const rb_placed b = {&p.core, {3, 3 + 1e-12, 4}, shapes_upright};
	rb_axis axis = {.a = &a, .b = &b, .noise = 1e-10, .second = -(double)INFINITY};

	rb_axis_try(&axis, (rb_vec3){1, 0, 0});
	assert_true(axis.found && axis.normal.x == 1);
	assert_near(axis.gap, 1, 0);
	/* better by less than the noise: it is only the second */
	rb_axis_try(&axis, (rb_vec3){0, 1, 0});
	assert_true(axis.normal.x == 1);
	assert_near(axis.second, 1 + 1e-12, 1e-15);
	/* better by more: what was best is the second */
	rb_axis_try(&axis, (rb_vec3){0, 0, 1});
	assert_true(axis.normal.z == 1);
	assert_near(axis.gap, 2, 0);
	assert_near(axis.second, 1, 0);
	/* worse than the second: nothing changes */
	rb_axis_try(&axis, (rb_vec3){0, 0, -1});
	assert_near(axis.gap, 2, 0);
	assert_near(axis.second, 1, 0);
	rb_polytope_destroy(p.polytope);
}

static void a_slab_becomes_thinner_and_never_thicker(void **state)
{
	const rb_axis none = {.found = false, .gap = 1};
	const rb_axis axis = {.found = true, .normal = {0, 1, 0}, .gap = 1.5, .noise = 0.01};
	rb_slab slab = {{1, 0, 0}, 2, 2};

	(void)state;
	rb_slab_tighten(&slab, &none);
	assert_true(slab.normal.x == 1 && slab.depth == 2);
	rb_slab_tighten(&slab, &axis); /* no farther than 2, no nearer than 1.5 */
	assert_true(slab.normal.y == 1);
	assert_near(slab.depth, 0.5 + 8 * 0.01, 1e-15);
	const rb_axis worse = {.found = true, .normal = {0, 0, 1}, .gap = 1, .noise = 0.01};
	rb_slab_tighten(&slab, &worse);
	assert_true(slab.normal.y == 1);
	/* a distance that is not known proves nothing */
	rb_slab open = {{1, 0, 0}, (double)INFINITY, (double)INFINITY};
	rb_slab_tighten(&open, &axis);
	assert_true(open.normal.x == 1 && isinf(open.depth));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_direction_proves_the_gap_of_the_intervals),
		cmocka_unit_test(the_best_stays_unless_it_is_beaten_by_more_than_rounding),
		cmocka_unit_test(a_slab_becomes_thinner_and_never_thicker),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
