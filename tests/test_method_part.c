/* SPDX-License-Identifier: MIT */
/* src/step/method_part.c: parts of methods, and whether a scene needs them */
#include "support.h"

#include "model/features.h"
#include "step/method_part.h"

static void a_part_that_needs_nothing_is_always_used(void **state)
{
	const struct rb_method_part part = {"move", "positions", 0};

	(void)state;
	for (rb_features features = 0; features < 8; features++) {
		const struct rb_model model = {.features = features};

		assert_true(rb_method_part_is_used(&part, &model));
		assert_string_equal(rb_method_part_why_not(&part, &model), "");
	}
}

static void a_part_is_used_where_any_of_its_features_is_there(void **state)
{
	const rb_features need = RB_FEATURE_GRAVITY | RB_FEATURE_DRAG;
	const struct rb_method_part part = {"forces", "", need};

	(void)state;
	for (int bit = 0; bit < 20; bit++) {
		const struct rb_model model = {.features = 1u << bit};

		assert_int_equal(rb_method_part_is_used(&part, &model),
		                 (1u << bit) == RB_FEATURE_GRAVITY ||
		                         (1u << bit) == RB_FEATURE_DRAG);
	}
	const struct rb_model both = {.features = need | RB_FEATURE_ROTATION};
	assert_true(rb_method_part_is_used(&part, &both));
}

/* In the words of the feature's row. */
static void a_part_that_is_left_out_says_why(void **state)
{
	int count;
	const struct rb_feature_row *const row = rb_feature_rows(&count);
	const struct rb_model none = {.features = 0};

	(void)state;
	for (int k = 0; k < count; k++) {
		const struct rb_method_part part = {"part", "", row[k].bit};
		const struct rb_model all = {.features = ~0u};

		assert_string_equal(rb_method_part_why_not(&part, &none), row[k].absent);
		assert_string_equal(rb_method_part_why_not(&part, &all), "");
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_part_that_needs_nothing_is_always_used),
		cmocka_unit_test(a_part_is_used_where_any_of_its_features_is_there),
		cmocka_unit_test(a_part_that_is_left_out_says_why),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
