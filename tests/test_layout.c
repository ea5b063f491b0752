/* SPDX-License-Identifier: MIT */
/* src/control/layout.c: which part of a screen is what, for screens of every size */
#include "support.h"

#include "control/layout.h"

enum { PARTS = 8 };

static void parts_of(const struct rb_layout *layout, rb_area parts[PARTS])
{
	const rb_area all[PARTS] = {layout->transport, layout->picture, layout->numbers,
	                            layout->charts,    layout->body,    layout->timeline,
	                            layout->log,       layout->bottom};

	memcpy(parts, all, sizeof all);
}

static bool is_shown(rb_area area)
{
	return area.width > 0 && area.height > 0;
}

/* No cell belongs to two parts, and none of a part lies beside the screen. */
static void parts_lie_apart_and_on_the_screen(void **state)
{
	(void)state;
	for (int width = RB_LAYOUT_WIDTH_MIN; width < 260; width++)
		for (int height = RB_LAYOUT_HEIGHT_MIN; height < 100; height++) {
			const struct rb_layout layout = rb_layout_of(width, height);
			rb_area parts[PARTS];

			assert_true(layout.fits);
			parts_of(&layout, parts);
			for (int i = 0; i < PARTS; i++) {
				const rb_area a = parts[i];

				assert_true(a.width >= 0 && a.height >= 0);
				if (!is_shown(a))
					continue;
				assert_true(a.x >= 0 && a.y >= 0 && a.x + a.width <= width &&
				            a.y + a.height <= height);
				for (int k = 0; k < i; k++) {
					const rb_area b = parts[k];
					const bool beside = a.x >= b.x + b.width ||
					                    b.x >= a.x + a.width;
					const bool below = a.y >= b.y + b.height ||
					                   b.y >= a.y + a.height;

					assert_true(!is_shown(b) || beside || below);
				}
			}
		}
}

/* Rows are all used; beside the picture a column is left free where something stands there. */
static void every_row_has_a_part_and_the_picture_is_never_lost(void **state)
{
	(void)state;
	for (int width = RB_LAYOUT_WIDTH_MIN; width < 260; width++)
		for (int height = RB_LAYOUT_HEIGHT_MIN; height < 100; height++) {
			const struct rb_layout layout = rb_layout_of(width, height);
			const int rows = layout.transport.height + layout.picture.height +
			                 layout.timeline.height + layout.log.height +
			                 layout.bottom.height;

			assert_int_equal(rows, height);
			assert_int_equal(layout.timeline.height, 1);
			assert_int_equal(layout.bottom.height, 1);
			assert_int_equal(layout.bottom.y, height - 1);
			assert_true(layout.log.height >= 1);
			/* what a picture is worth having of */
			assert_true(layout.picture.width >= RB_LAYOUT_WIDTH_MIN);
			assert_true(layout.picture.height >= 7);
			assert_true(2 * layout.picture.height >= height - 5);
			const int side = layout.numbers.width;
			assert_int_equal(layout.picture.width + side + (side > 0), width);
		}
}

static void a_larger_screen_shows_no_less(void **state)
{
	(void)state;
	for (int width = 20; width < 259; width++)
		for (int height = 5; height < 99; height++) {
			const struct rb_layout small = rb_layout_of(width, height);
			const struct rb_layout taller = rb_layout_of(width, height + 1);
			const struct rb_layout wider = rb_layout_of(width + 1, height);
			rb_area parts[PARTS], more[PARTS], beside[PARTS];

			parts_of(&small, parts);
			parts_of(&taller, more);
			parts_of(&wider, beside);
			for (int i = 0; i < PARTS; i++) {
				assert_true(!is_shown(parts[i]) || is_shown(more[i]));
				assert_true(!is_shown(parts[i]) || is_shown(beside[i]));
			}
		}
}

static void too_small_a_screen_shows_nothing(void **state)
{
	static const int sizes[][2] = {{0, 0},   {39, 100}, {200, 11}, {-1, -1},
	                               {-5, 80}, {80, -5},  {39, 11},  {1, 1}};

	(void)state;
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		const struct rb_layout layout = rb_layout_of(sizes[i][0], sizes[i][1]);
		rb_area parts[PARTS];

		assert_false(layout.fits);
		parts_of(&layout, parts);
		for (int k = 0; k < PARTS; k++)
			assert_false(is_shown(parts[k]));
	}
	assert_true(rb_layout_of(40, 12).fits);
}

/* A terminal of the usual size, a narrower one, a large one. */
static void eighty_columns_have_numbers_beside_the_picture(void **state)
{
	const struct rb_layout usual = rb_layout_of(80, 24), narrow = rb_layout_of(79, 24),
			       large = rb_layout_of(200, 60);

	(void)state;
	assert_true(is_shown(usual.numbers) && is_shown(usual.charts));
	assert_true(usual.numbers.x > usual.picture.x + usual.picture.width);
	assert_true(usual.charts.y == usual.numbers.y + usual.numbers.height);
	assert_false(is_shown(narrow.numbers) || is_shown(narrow.charts) || is_shown(narrow.body));
	assert_int_equal(narrow.picture.width, 79);
	assert_true(is_shown(large.body));
	assert_true(large.log.height > usual.log.height);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(parts_lie_apart_and_on_the_screen),
		cmocka_unit_test(every_row_has_a_part_and_the_picture_is_never_lost),
		cmocka_unit_test(a_larger_screen_shows_no_less),
		cmocka_unit_test(too_small_a_screen_shows_nothing),
		cmocka_unit_test(eighty_columns_have_numbers_beside_the_picture),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
