/* SPDX-License-Identifier: MIT */
/* src/joint/: the rows of the kinds of joints, and what every part of the program assumes of them. */
#include "support.h"

#include <string.h>

#include "joint/joint_types.h"

static struct rb_linkage link_of(int kind)
{
	return (struct rb_linkage){.type = &rb_joint_type(kind)->linkage,
	                           .frame_a = {1, 0, 0, 0},
	                           .frame_b = {1, 0, 0, 0},
	                           .length = 1};
}

/* By what a kind leaves free: 6 less the freedoms of b against a. */
static void kinds_have_as_many_rows_as_they_take_freedoms(void **state)
{
	static const int rows[RB_JOINT_KIND_COUNT] = {
		[RB_JOINT_FIXED] = 6,  [RB_JOINT_BALL] = 3,        [RB_JOINT_HINGE] = 5,
		[RB_JOINT_SLIDER] = 5, [RB_JOINT_CYLINDRICAL] = 4, [RB_JOINT_UNIVERSAL] = 4,
		[RB_JOINT_ROD] = 1,    [RB_JOINT_ROPE] = 1};

	(void)state;
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++) {
		const struct rb_linkage link = link_of(kind);

		assert_int_equal(rb_linkage_row_count(&link), rows[kind]);
	}
}

static void names_are_those_of_scenes_in_order(void **state)
{
	char names[sizeof RB_JOINT_KIND_NAMES + 2 * RB_JOINT_KIND_COUNT] = "";

	(void)state;
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++) {
		strcat(names, kind == 0 ? "" : ", ");
		strcat(names, rb_joint_type(kind)->name);
		assert_non_null(strstr(rb_joint_type(kind)->noun, rb_joint_type(kind)->name));
	}
	assert_string_equal(names, RB_JOINT_KIND_NAMES);
}

/* What methods assume: see struct rb_linkage_type and struct rb_joint_type. */
static void rows_of_kinds_fit_together(void **state)
{
	(void)state;
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++) {
		const struct rb_joint_type *const type = rb_joint_type(kind);
		const struct rb_linkage link = link_of(kind);

		assert_true(rb_linkage_row_count(&link) <= RB_LINKAGE_ROWS_MAX);
		assert_true(type->linkage.condition[1] != &rb_linkage_same_point);
		if (type->linkage.one_sided)
			assert_true(rb_linkage_row_count(&link) == 1 &&
			            !rb_linkage_row_is_couple(&link, 0));
		/* angles and ways are about or along an axis */
		if (rb_joint_is_free(kind))
			assert_true(type->has_axis);
		if (type->has_axis_b)
			assert_true(type->has_axis);
		if (rb_joint_is_line(kind))
			assert_true(!type->has_axis && !type->is_centered &&
			            !type->linkage.condition[0]->couples);
		assert_true(rb_joint_is_free(kind) == rb_linkage_has_free(&link));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(kinds_have_as_many_rows_as_they_take_freedoms),
		cmocka_unit_test(names_are_those_of_scenes_in_order),
		cmocka_unit_test(rows_of_kinds_fit_together),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
