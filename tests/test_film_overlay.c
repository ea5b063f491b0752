/* SPDX-License-Identifier: MIT */
/* src/film/overlay.c */
#include "support.h"

#include "base/memory.h"
#include "film/overlay.h"

#include <time.h>

enum { W = 640, H = 360 };

/* Where a picture differs from its background. */
struct box {
	int left, right, top, bottom, count;
};

static struct rb_overlay *overlay_of(int height)
{
	struct rb_overlay *overlay;
	struct rb_error err;

	assert_ok(rb_overlay_create(&overlay, 16 * height / 9, height, &err));
	return overlay;
}

static struct rb_pixmap grey(uint8_t value)
{
	struct rb_pixmap pixmap;

	assert_int_equal(rb_pixmap_init(&pixmap, W, H, NULL), RB_OK);
	for (int i = 0; i < W * H; i++)
		memset(pixmap.rgba + 4 * i, value, 3);
	return pixmap;
}

static struct box box_of(const struct rb_pixmap *pixmap, uint8_t background)
{
	struct box box = {W, -1, H, -1, 0};

	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			const uint8_t *p = pixmap->rgba + 4 * (y * W + x);
			assert_int_equal(p[3], 255);
			if (p[0] == background)
				continue;
			box.count++;
			box.left = x < box.left ? x : box.left;
			box.right = x > box.right ? x : box.right;
			box.top = y < box.top ? y : box.top;
			box.bottom = y > box.bottom ? y : box.bottom;
		}
	return box;
}

static struct box written(enum rb_overlay_corner corner, int line, const char *text)
{
	struct rb_overlay *overlay = overlay_of(H);
	struct rb_pixmap pixmap = grey(100);

	rb_overlay_write(overlay, &pixmap, corner, line, text);
	const struct box box = box_of(&pixmap, 100);
	rb_pixmap_release(&pixmap);
	rb_overlay_destroy(overlay);
	return box;
}

static void each_corner_has_its_text_and_lines_go_inwards(void **state)
{
	const struct box top_left = written(RB_OVERLAY_TOP_LEFT, 0, "Hxg");
	const struct box top_right = written(RB_OVERLAY_TOP_RIGHT, 0, "Hxg");
	const struct box bottom_left = written(RB_OVERLAY_BOTTOM_LEFT, 0, "Hxg");
	const struct box bottom_right = written(RB_OVERLAY_BOTTOM_RIGHT, 0, "Hxg");
	const struct box second = written(RB_OVERLAY_TOP_LEFT, 1, "Hxg");
	const struct box above = written(RB_OVERLAY_BOTTOM_RIGHT, 1, "Hxg");

	(void)state;
	assert_true(top_left.count > 100);
	assert_true(top_left.left < W / 10 && top_left.right < W / 4 && top_left.bottom < H / 8);
	assert_true(top_right.right > W * 9 / 10 && top_right.left > W * 3 / 4);
	assert_true(bottom_left.top > H * 7 / 8 && bottom_left.right < W / 4);
	assert_true(bottom_right.top > H * 7 / 8 && bottom_right.left > W * 3 / 4);
	assert_int_equal(second.left, top_left.left);
	assert_true(second.top >= top_left.bottom - 4);
	assert_true(above.bottom <= bottom_right.top + 4);
	/* nothing touches the edge */
	assert_true(top_left.left > 0 && top_left.top > 0);
	assert_true(bottom_right.right < W - 1 && bottom_right.bottom < H - 1);
}

/* The brightest and the darkest pixel say whether letters can be told from what is behind them. */
static void text_can_be_read_on_white_and_on_black(void **state)
{
	struct rb_overlay *overlay = overlay_of(H);

	(void)state;
	for (int value = 0; value <= 255; value += 51) {
		struct rb_pixmap pixmap = grey((uint8_t)value);
		int darkest = 255, brightest = 0;
		rb_overlay_write(overlay, &pixmap, RB_OVERLAY_TOP_LEFT, 0, "HHHH");
		for (int i = 0; i < W * H; i++) {
			const int p = pixmap.rgba[4 * i];
			darkest = p < darkest ? p : darkest;
			brightest = p > brightest ? p : brightest;
		}
		assert_true(brightest > 240);
		assert_true(darkest < 140);
		rb_pixmap_release(&pixmap);
	}
	rb_overlay_destroy(overlay);
}

/* Half covered, white over black is half of the light, which is not half of the number. */
static void letters_are_blended_in_linear_light(void **state)
{
	struct rb_overlay *overlay = overlay_of(H);
	struct rb_pixmap black = grey(0), light = grey(250);
	int compared = 0;

	(void)state;
	rb_overlay_write(overlay, &black, RB_OVERLAY_TOP_LEFT, 0, "Sgo8");
	rb_overlay_write(overlay, &light, RB_OVERLAY_TOP_LEFT, 0, "Sgo8");
	/* black tells how much of a pixel is covered, whatever the rim; where all is letter both agree */
	for (int i = 0; i < W * H; i++) {
		const double v = black.rgba[4 * i] / 255.0;
		const double cover = (v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4)) /
		                     0.96;
		if (cover > 0.99) {
			assert_near(light.rgba[4 * i], black.rgba[4 * i], 2);
			compared++;
		}
		if (cover > 0.3 && cover < 0.7) /* as numbers, half would be near 125 */
			assert_true(black.rgba[4 * i] > 140);
	}
	assert_true(compared > 20);
	rb_pixmap_release(&black);
	rb_pixmap_release(&light);
	rb_overlay_destroy(overlay);
}

/* Only what is right of a digit may look different when the digit changes. */
static void digits_keep_their_places(void **state)
{
	static const char digits[] = "0123456789";
	struct rb_overlay *overlay = overlay_of(H);
	char text[] = "t = 0.25 s";
	struct rb_pixmap first = grey(100);

	(void)state;
	rb_overlay_write(overlay, &first, RB_OVERLAY_TOP_LEFT, 0, text);
	const struct box box = box_of(&first, 100);
	for (int k = 0; k < 10; k++) {
		struct rb_pixmap other = grey(100);
		text[4] = digits[k];
		rb_overlay_write(overlay, &other, RB_OVERLAY_TOP_LEFT, 0, text);
		/* the last quarter, ".25 s", stands where it was */
		for (int y = 0; y < H; y++)
			assert_memory_equal(
				first.rgba + 4 * (y * W + box.right - (box.right - box.left) / 4),
				other.rgba + 4 * (y * W + box.right - (box.right - box.left) / 4),
				(size_t)(box.right - box.left));
		rb_pixmap_release(&other);
	}
	/* a figure space takes a digit's place */
	const struct box wide = written(RB_OVERLAY_TOP_LEFT, 0, "t = 10.25 s");
	const struct box padded = written(RB_OVERLAY_TOP_LEFT, 0,
	                                  "t = \xe2\x80\x87"
	                                  "0.25 s");
	assert_int_equal(wide.right, padded.right);
	rb_pixmap_release(&first);
	rb_overlay_destroy(overlay);
}

static void a_line_that_is_too_long_is_cut_within_the_picture(void **state)
{
	char text[3000];

	(void)state;
	for (size_t size = 10; size < sizeof text; size *= 3) {
		memset(text, 'm', size);
		text[size] = '\0';
		for (int corner = 0; corner < 4; corner++) {
			const struct box box = written((enum rb_overlay_corner)corner, 0, text);
			assert_true(box.left > 0 && box.right < W - 1);
			if (size > 100)
				assert_true(box.right - box.left > W * 8 / 10);
		}
	}
	/* a letter shortened is not the same as all letters */
	memset(text, 'm', 100);
	strcpy(text + 100, "END");
	const struct box cut = written(RB_OVERLAY_TOP_LEFT, 0, text);
	strcpy(text + 100, "DIFFERENT");
	const struct box other = written(RB_OVERLAY_TOP_LEFT, 0, text);
	assert_int_equal(cut.count, other.count);
}

static void any_bytes_are_a_text_and_other_places_stay_as_they_were(void **state)
{
	static const char *const texts[] = {"",
	                                    " ",
	                                    "\xff\xfe\x80",
	                                    "\xc3",
	                                    "\xe2\x80",
	                                    "\xf4\x90\x80\x80",
	                                    "K\xc3\xb6rper \xe2\x86\x92 \xf0\x9f\x8e\xb1",
	                                    "a\nb\tc\x01"};
	struct rb_overlay *overlay = overlay_of(H);

	(void)state;
	for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
		struct rb_pixmap pixmap = grey(100);
		rb_overlay_write(overlay, &pixmap, RB_OVERLAY_TOP_LEFT, 0, texts[k]);
		const struct box box = box_of(&pixmap, 100);
		assert_true(box.bottom < H / 6);
		assert_int_equal(box.count > 0, k >= 2);
		/* lines beyond the picture are not seen, and not written elsewhere */
		rb_overlay_write(overlay, &pixmap, RB_OVERLAY_TOP_LEFT, 1000, "text");
		rb_overlay_write(overlay, &pixmap, RB_OVERLAY_BOTTOM_RIGHT, 1000, "text");
		assert_int_equal(box_of(&pixmap, 100).count, box.count);
		rb_pixmap_release(&pixmap);
	}
	rb_overlay_destroy(overlay);
}

/* More different letters than are kept. */
static void many_letters_look_the_same_as_few(void **state)
{
	struct rb_overlay *overlay = overlay_of(H);
	struct rb_pixmap before = grey(100), after = grey(100), rest = grey(100);
	char text[8];

	(void)state;
	rb_overlay_write(overlay, &before, RB_OVERLAY_TOP_LEFT, 0, "Energy 4.5 J");
	for (unsigned code = 0x100; code < 0x500; code++) {
		snprintf(text, sizeof text, "%c%c", (char)(0xc0 | code >> 6),
		         (char)(0x80 | (code & 63)));
		rb_overlay_write(overlay, &rest, RB_OVERLAY_TOP_LEFT, 0, text);
	}
	rb_overlay_write(overlay, &after, RB_OVERLAY_TOP_LEFT, 0, "Energy 4.5 J");
	assert_memory_equal(before.rgba, after.rgba, 4 * W * H);
	rb_pixmap_release(&before);
	rb_pixmap_release(&after);
	rb_pixmap_release(&rest);
	rb_overlay_destroy(overlay);
}

static void letters_grow_with_the_picture_and_tiny_pictures_are_no_danger(void **state)
{
	struct rb_overlay *overlay = overlay_of(2 * H);
	struct rb_pixmap large = grey(100), tiny;

	(void)state;
	const struct box small = written(RB_OVERLAY_TOP_LEFT, 0, "Hxg");
	rb_overlay_write(overlay, &large, RB_OVERLAY_TOP_LEFT, 0, "Hxg");
	const struct box twice = box_of(&large, 100);
	assert_near((twice.bottom - twice.top) / (double)(small.bottom - small.top), 2, 0.3);
	rb_pixmap_release(&large);
	for (int size = 1; size < 40; size += 3) {
		assert_int_equal(rb_pixmap_init(&tiny, size, size, NULL), RB_OK);
		for (int corner = 0; corner < 4; corner++)
			rb_overlay_write(overlay, &tiny, (enum rb_overlay_corner)corner, 0, "text");
		rb_pixmap_release(&tiny);
	}
	rb_overlay_destroy(overlay);
}

/* The largest picture there may be. Glyphs are made once, but then at their full size. */
static void the_work_for_letters_is_bounded(void **state)
{
	static const int sizes[][2] = {{16384, 16384}, {1, 16384}, {16384, 1}};
	struct rb_overlay *overlay;
	struct rb_pixmap pixmap;
	struct rb_error err;

	(void)state;
	for (size_t k = 0; k < 3; k++) {
		const clock_t begin = clock();
		const int width = k == 0 ? 2400 : sizes[k][0], height = k == 0 ? 1200 : sizes[k][1];
		assert_ok(rb_overlay_create(&overlay, sizes[k][0], sizes[k][1], &err));
		assert_ok(rb_pixmap_init(&pixmap, width, height, &err));
		rb_overlay_write(overlay, &pixmap, RB_OVERLAY_TOP_LEFT, 0, "g8mW%");
		rb_overlay_write(overlay, &pixmap, RB_OVERLAY_BOTTOM_RIGHT, 1, "g8mW%");
		rb_pixmap_release(&pixmap);
		rb_overlay_destroy(overlay);
		assert_true((double)(clock() - begin) / CLOCKS_PER_SEC < 4);
	}
}

static void letters_suit_the_shorter_side(void **state)
{
	struct rb_overlay *narrow;
	struct rb_pixmap pixmap = grey(100);
	struct rb_error err;

	(void)state;
	assert_ok(rb_overlay_create(&narrow, W, 4 * W, &err));
	rb_overlay_write(narrow, &pixmap, RB_OVERLAY_TOP_LEFT, 0, "Hxg");
	const struct box found = box_of(&pixmap, 100);
	const struct box wanted = written(RB_OVERLAY_TOP_LEFT, 0, "Hxg");
	assert_int_equal(found.right, wanted.right);
	assert_int_equal(found.bottom, wanted.bottom);
	rb_pixmap_release(&pixmap);
	rb_overlay_destroy(narrow);
}

static void texts_that_fit_side_by_side_do_not_touch(void **state)
{
	struct rb_overlay *overlay = overlay_of(H);
	char left[40] = "", right[40] = "";
	int fitted = 0;

	(void)state;
	for (int i = 0; i < 30; i++) {
		left[i] = right[i] = 'm';
		const int first = written(RB_OVERLAY_TOP_LEFT, 0, left).right;
		const int second = written(RB_OVERLAY_TOP_RIGHT, 0, right).left;
		const bool fits = rb_overlay_fits(overlay, W, left, right);
		assert_true(!fits || second - first > 4);
		assert_true(fits || second - first < 24);
		fitted += fits;
	}
	assert_true(fitted > 5 && fitted < 25);
	rb_overlay_destroy(overlay);
}

static void a_font_that_is_missing_is_told_by_name_and_all_is_given_back(void **state)
{
	const struct rb_memory_counts before = rb_memory_counts();
	struct rb_overlay *overlay;
	struct rb_error err;

	(void)state;
	setenv("RBSIM_FONT", "/nonexistent/font.ttf", 1);
	assert_int_equal(rb_overlay_create(&overlay, W, H, &err), RB_ERR_MISSING);
	assert_null(overlay);
	assert_non_null(strstr(err.text, "'/nonexistent/font.ttf'"));
	unsetenv("RBSIM_FONT");
	overlay = overlay_of(H);
	struct rb_pixmap pixmap = grey(100);
	rb_overlay_write(overlay, &pixmap, RB_OVERLAY_TOP_LEFT, 0, "text");
	rb_pixmap_release(&pixmap);
	rb_overlay_destroy(overlay);
	rb_overlay_destroy(NULL);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_corner_has_its_text_and_lines_go_inwards),
		cmocka_unit_test(text_can_be_read_on_white_and_on_black),
		cmocka_unit_test(letters_are_blended_in_linear_light),
		cmocka_unit_test(digits_keep_their_places),
		cmocka_unit_test(a_line_that_is_too_long_is_cut_within_the_picture),
		cmocka_unit_test(any_bytes_are_a_text_and_other_places_stay_as_they_were),
		cmocka_unit_test(many_letters_look_the_same_as_few),
		cmocka_unit_test(letters_grow_with_the_picture_and_tiny_pictures_are_no_danger),
		cmocka_unit_test(the_work_for_letters_is_bounded),
		cmocka_unit_test(letters_suit_the_shorter_side),
		cmocka_unit_test(texts_that_fit_side_by_side_do_not_touch),
		cmocka_unit_test(a_font_that_is_missing_is_told_by_name_and_all_is_given_back),
	};

	return cmocka_run_group_tests_name("film_overlay", tests, NULL, NULL);
}
