/* SPDX-License-Identifier: MIT */
/* src/shape/rectangle.c */
#include "slices.h"

static const struct rb_shape_type *const row = &rb_shape_rectangle;
static const struct rb_shape sheet = {.kind = RB_SHAPE_RECTANGLE, .size = {2, 0.6}};

/* w/2 |nx| + h/2 |ny|, and nothing along z: it has no thickness. */
static void its_core_reaches_to_its_corners(void **state)
{
	(void)state;
	for (int k = 0; k < 100; k++) {
		const rb_vec3 n = rb_vec3_unit(rb_vec3_of(sin(k), cos(2 * k), sin(3 * k + 1)),
		                               rb_vec3_of(1, 0, 0));

		assert_near(slices_support(row, &sheet, n), fabs(n.x) + 0.3 * fabs(n.y), 1e-15);
	}
	assert_near(slices_support(row, &sheet, rb_vec3_of(0, 0, 1)), 0, 0);
	assert_near(slices_support(row, &sheet, rb_vec3_of(0, 0, -1)), 0, 0);
}

static void it_has_no_volume_and_reads_two_sizes(void **state)
{
	(void)state;
	assert_true(rb_shape_volume(NULL, &sheet) == 0);
	assert_true(isinf(rb_shape_half_width(NULL, &sheet)));
	assert_int_equal(row->reads, RB_SHAPE_READS_SIZE_X | RB_SHAPE_READS_SIZE_Y);
	assert_false(row->is_part);
}

static void its_sizes_must_be_positive_and_finite(void **state)
{
	struct rb_shape shape = sheet;
	double *const number[] = {&shape.size[0], &shape.size[1]};

	(void)state;
	slices_assert_faults(row, &sheet, number, 2, &shape);
}

static void without_memory_it_has_no_core(void **state)
{
	struct rb_error err;
	rb_core core;

	(void)state;
	for (uint64_t k = 1; k < 4; k++) {
		rb_memory_fail_at(k);
		const enum rb_status status = row->core(&sheet, &core, &err);
		rb_memory_fail_at(0);
		assert_int_equal(status, RB_ERR_MEMORY);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(its_core_reaches_to_its_corners),
		cmocka_unit_test(it_has_no_volume_and_reads_two_sizes),
		cmocka_unit_test(its_sizes_must_be_positive_and_finite),
		cmocka_unit_test(without_memory_it_has_no_core),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
