/* SPDX-License-Identifier: MIT */
/* src/shape/plane.c */
#include "slices.h"

static const struct rb_shape_type *const row = &rb_shape_plane;
static const struct rb_shape floor_shape = {.kind = RB_SHAPE_PLANE};

/* All z <= 0: nothing along z, without end along any other direction. */
static void its_core_is_the_half_space_below(void **state)
{
	(void)state;
	assert_near(slices_support(row, &floor_shape, rb_vec3_of(0, 0, 1)), 0, 0);
	for (int k = 1; k < 32; k++) {
		const double angle = 0.2 * k;
		const rb_vec3 n = {sin(angle) * cos(k), sin(angle) * sin(k), cos(angle)};

		assert_true(isinf(slices_support(row, &floor_shape, n)));
	}
}

static void it_has_no_numbers_and_so_no_faults(void **state)
{
	char text[160];

	(void)state;
	assert_int_equal(row->reads, 0);
	assert_null(row->fault);
	assert_true(rb_shape_volume(NULL, &floor_shape) == 0);
	assert_true(rb_shape_reach(NULL, &floor_shape) == 0);
	assert_true(isinf(rb_shape_half_width(NULL, &floor_shape)));
	rb_shape_text(NULL, &floor_shape, text);
	assert_string_equal(text, "plane");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(its_core_is_the_half_space_below),
		cmocka_unit_test(it_has_no_numbers_and_so_no_faults),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
