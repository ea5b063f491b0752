/* SPDX-License-Identifier: MIT */
/* src/control/charts.c: small charts and the time line */
#include "support.h"

#include "control/charts.h"

static const double nan_value = (double)NAN, infinite = (double)INFINITY;

static void the_range_passes_over_what_is_no_number(void **state)
{
	const double values[] = {nan_value, 3, -infinite, -2, infinite, 7, nan_value};
	double low = 9, high = 9;

	(void)state;
	rb_chart_range(values, 7, &low, &high);
	assert_true(low == -2 && high == 7);
	rb_chart_range(values, 1, &low, &high);
	assert_true(low == 0 && high == 0);
	rb_chart_range(values + 1, 1, &low, &high);
	assert_true(low == 3 && high == 3);
	rb_chart_range(values, 0, &low, &high);
	assert_true(low == 0 && high == 0);
}

static void higher_values_have_higher_blocks(void **state)
{
	const double values[] = {0, 0.99, 1, 2, 3.5, 7.99, 8, -5, 100, nan_value};
	uint32_t glyphs[10];

	(void)state;
	rb_chart_spark(glyphs, values, 10, 0, 8, true);
	assert_int_equal(glyphs[0], 0x2581);
	assert_int_equal(glyphs[1], 0x2581); /* the first eighth */
	assert_int_equal(glyphs[2], 0x2582);
	assert_int_equal(glyphs[3], 0x2583);
	assert_int_equal(glyphs[4], 0x2584);
	assert_int_equal(glyphs[5], 0x2588);
	assert_int_equal(glyphs[6], 0x2588);
	assert_int_equal(glyphs[7], 0x2581); /* out of the range: its ends */
	assert_int_equal(glyphs[8], 0x2588);
	assert_int_equal(glyphs[9], ' '); /* a gap */
}

static void without_blocks_there_are_plain_characters_of_their_own(void **state)
{
	double values[8];
	uint32_t glyphs[8];

	(void)state;
	for (int i = 0; i < 8; i++)
		values[i] = i + 0.5;
	rb_chart_spark(glyphs, values, 8, 0, 8, false);
	for (int i = 0; i < 8; i++) {
		assert_in_range(glyphs[i], 0x21, 0x7e);
		for (int j = 0; j < i; j++)
			assert_true(glyphs[i] != glyphs[j]);
	}
}

static void where_all_is_the_same_all_is_low(void **state)
{
	const double values[] = {5, 5, 5};
	uint32_t glyphs[3];

	(void)state;
	rb_chart_spark(glyphs, values, 3, 5, 5, true);
	for (int i = 0; i < 3; i++)
		assert_int_equal(glyphs[i], 0x2581);
}

static void the_time_line_shows_where_it_stands_and_what_there_is(void **state)
{
	const uint64_t marks[] = {0, 0, 0, 3, 0};
	const struct rb_timeline line = {
		.position = 0.2, .available = 0.8, .marks = marks, .mark_count = 5};
	uint32_t glyphs[11];
	char text[12] = "";

	(void)state;
	rb_chart_timeline(glyphs, 11, &line, false);
	for (int i = 0; i < 11; i++)
		text[i] = (char)glyphs[i];
	/* the mark's part is the fourth fifth: its middle at 0.7 */
	assert_string_equal(text, "==O----!-..");
}

static void a_column_of_the_time_line_is_found_where_it_was_drawn(void **state)
{
	(void)state;
	for (int width = 2; width < 60; width += 7)
		for (int column = 0; column < width; column++) {
			const struct rb_timeline line = {
				.position = rb_chart_timeline_at(width, column), .available = 1};
			uint32_t glyphs[64];

			rb_chart_timeline(glyphs, width, &line, false);
			for (int i = 0; i < width; i++)
				assert_int_equal(glyphs[i] == 'O', i == column);
		}
}

/* Positions that are none, and a width of nothing: nothing is written beyond. */
static void positions_out_of_the_run_are_its_ends(void **state)
{
	uint32_t glyphs[6] = {0, 0, 0, 0, 0, 77};

	(void)state;
	rb_chart_timeline(glyphs, 5, &(struct rb_timeline){.position = 9, .available = -4}, false);
	assert_int_equal(glyphs[4], 'O');
	rb_chart_timeline(glyphs, 5, &(struct rb_timeline){.position = -9, .available = 9}, false);
	assert_int_equal(glyphs[0], 'O');
	glyphs[0] = 77;
	rb_chart_timeline(glyphs, 0, &(struct rb_timeline){.position = 0.5}, false);
	assert_true(glyphs[0] == 77 && glyphs[5] == 77);
	assert_near(rb_chart_timeline_at(1, 0), 0, 0);
	assert_near(rb_chart_timeline_at(10, 99), 1, 0);
	assert_near(rb_chart_timeline_at(10, -3), 0, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_range_passes_over_what_is_no_number),
		cmocka_unit_test(higher_values_have_higher_blocks),
		cmocka_unit_test(without_blocks_there_are_plain_characters_of_their_own),
		cmocka_unit_test(where_all_is_the_same_all_is_low),
		cmocka_unit_test(the_time_line_shows_where_it_stands_and_what_there_is),
		cmocka_unit_test(a_column_of_the_time_line_is_found_where_it_was_drawn),
		cmocka_unit_test(positions_out_of_the_run_are_its_ends),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
