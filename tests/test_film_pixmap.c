/* SPDX-License-Identifier: MIT */
/* src/film/pixmap.c: a picture in memory */
#include "support.h"

#include <limits.h>

#include "film/pixmap.h"

static void a_new_picture_is_opaque_black_to_its_last_pixel(void **state)
{
	static const int sizes[][2] = {{1, 1}, {3, 1}, {1, 3}, {640, 2}, {17, 19}};
	struct rb_pixmap picture;
	struct rb_error err;

	(void)state;
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		assert_ok(rb_pixmap_init(&picture, sizes[i][0], sizes[i][1], &err));
		assert_int_equal(picture.width, sizes[i][0]);
		assert_int_equal(picture.height, sizes[i][1]);
		const size_t bytes = (size_t)sizes[i][0] * (size_t)sizes[i][1] * 4;
		for (size_t k = 0; k < bytes; k++)
			assert_int_equal(picture.rgba[k], k % 4 == 3 ? 255 : 0);
		memset(picture.rgba, 1, bytes); /* all of it is there: its end is watched */
		rb_pixmap_release(&picture);
	}
}

static void releasing_may_be_done_again(void **state)
{
	struct rb_pixmap picture = {0};
	struct rb_error err;

	(void)state;
	rb_pixmap_release(&picture);
	assert_ok(rb_pixmap_init(&picture, 2, 2, &err));
	rb_pixmap_release(&picture);
	assert_null(picture.rgba);
	assert_int_equal(picture.width, 0);
	assert_int_equal(picture.height, 0);
	rb_pixmap_release(&picture);
}

static void what_memory_does_not_hold_is_told_with_its_size(void **state)
{
	struct rb_pixmap picture = {.width = 7};
	struct rb_error err;

	(void)state;
	/* nearly 2^64 bytes: with what stands around a block they would wrap round to a few */
	assert_int_equal(rb_pixmap_init(&picture, INT_MAX, INT_MAX, &err), RB_ERR_MEMORY);
	assert_string_equal(err.text,
	                    "cannot hold a picture of 2147483647 x 2147483647 pixels: out "
	                    "of memory");
	assert_null(picture.rgba);
	assert_int_equal(picture.width, 0);
	rb_memory_fail_at(1);
	const enum rb_status status = rb_pixmap_init(&picture, 3, 2, &err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	assert_string_equal(err.text, "cannot hold a picture of 3 x 2 pixels: out of memory");
	rb_pixmap_release(&picture);
	assert_int_equal(rb_pixmap_init(&picture, INT_MAX, INT_MAX, NULL), RB_ERR_MEMORY);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_new_picture_is_opaque_black_to_its_last_pixel),
		cmocka_unit_test(releasing_may_be_done_again),
		cmocka_unit_test(what_memory_does_not_hold_is_told_with_its_size),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
