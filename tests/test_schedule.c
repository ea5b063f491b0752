/* SPDX-License-Identifier: MIT */
/* src/flow/schedule.c */
#include "support.h"

#include "flow/schedule.h"

static struct rb_camera_def camera_of(double from_s, double to_s, double fps, double speed)
{
	struct rb_camera_def camera = {0};

	camera.from_s = from_s;
	camera.to_s = to_s;
	camera.fps = fps;
	camera.speed = speed;
	return camera;
}

static struct rb_schedule schedule_of(double from_s, double to_s, double fps, double speed)
{
	return (struct rb_schedule){.from_s = from_s, .to_s = to_s, .fps = fps, .speed = speed};
}

static void a_camera_without_wishes_takes_a_picture_of_every_frame_to_the_bit(void **state)
{
	const double rates[] = {60, 24, 25, 1000, 59.94, 3};
	const struct rb_camera_def camera = camera_of(0, (double)INFINITY, (double)NAN, 1);

	(void)state;
	for (size_t r = 0; r < sizeof rates / sizeof *rates; r++) {
		/* 600 intervals, the last frame at the duration (rb_model_frame_time) */
		const double end = 600 / rates[r];
		const struct rb_schedule schedule = rb_schedule_of(&camera, rates[r], end);

		assert_int_equal(rb_schedule_count(&schedule), 601);
		for (uint64_t k = 0; k <= 600; k++)
			assert_true(rb_schedule_time(&schedule, k) == (double)k / rates[r]);
	}
}

static void a_whole_number_of_intervals_is_not_lost_to_rounding(void **state)
{
	(void)state;
	/* 0.1, 0.7 and 2.3 are no doubles; 1/7 of a second neither */
	const struct rb_schedule short_of_it = schedule_of(0.1, 2.3, 50, 1);
	assert_int_equal(rb_schedule_count(&short_of_it), 111);
	const struct rb_schedule sevenths = schedule_of(0, 1 / 7.0 * 3, 7, 1);
	assert_int_equal(rb_schedule_count(&sevenths), 4);
	const struct rb_schedule late = schedule_of(86400.1, 86400.4, 10, 1);
	assert_int_equal(rb_schedule_count(&late), 4);
	const struct rb_schedule slow = schedule_of(0, 0.7, 30, 0.1);
	assert_int_equal(rb_schedule_count(&slow), 211);
	/* and a bit less than a whole number is less */
	const struct rb_schedule less = schedule_of(0, 0.9999999, 10, 1);
	assert_int_equal(rb_schedule_count(&less), 10);
}

static void slow_motion_takes_more_pictures_and_time_lapse_fewer(void **state)
{
	const struct rb_schedule slow = schedule_of(1, 3, 60, 0.25);
	const struct rb_schedule fast = schedule_of(0, 100, 25, 10);

	(void)state;
	assert_int_equal(rb_schedule_count(&slow), 481);
	assert_near(rb_schedule_time(&slow, 1), 1 + 1 / 240.0, 0);
	assert_int_equal(rb_schedule_count(&fast), 251);
	assert_near(rb_schedule_time(&fast, 1), 0.4, 0);
}

static void the_camera_ends_with_the_run_and_no_picture_is_later(void **state)
{
	const struct rb_camera_def camera = camera_of(0.5, 5, 30, 1);
	const struct rb_schedule cut = rb_schedule_of(&camera, 60, 2);
	const struct rb_schedule whole = rb_schedule_of(&camera, 60, 20);

	(void)state;
	assert_true(cut.to_s == 2 && whole.to_s == 5);
	assert_int_equal(rb_schedule_count(&cut), 46);
	for (int i = 1; i < 200; i++) {
		const struct rb_schedule thirds = schedule_of(0.1 * i, 0.1 * i + i / 3.0, 3, 1);
		const uint64_t count = rb_schedule_count(&thirds);

		assert_int_equal(count, i + 1);
		assert_true(rb_schedule_time(&thirds, count - 1) <= thirds.to_s);
		assert_near(rb_schedule_time(&thirds, count - 1), thirds.to_s, 1e-13);
	}
}

static void a_moment_is_one_picture_and_a_camera_after_the_end_takes_none(void **state)
{
	const struct rb_schedule moment = schedule_of(1, 1, 60, 1);
	const struct rb_schedule after = schedule_of(3, 2, 60, 1);

	(void)state;
	assert_int_equal(rb_schedule_count(&moment), 1);
	assert_true(rb_schedule_time(&moment, 0) == 1);
	assert_int_equal(rb_schedule_count(&after), 0);
}

static void a_film_without_end_has_a_number_of_pictures(void **state)
{
	const struct rb_schedule endless = schedule_of(0, 1e300, 60, 1e-3);

	(void)state;
	assert_true(rb_schedule_count(&endless) > (uint64_t)1 << 52);
}

static void a_film_whose_speed_varies_has_the_times_that_were_made_for_it(void **state)
{
	static const double times[] = {1, 1.25, 1.5, 2.5, 2.75};
	struct rb_camera_def camera = camera_of(1, (double)INFINITY, 4, 1), other = {0};

	(void)state;
	camera.speed_varies = true;
	camera.picture_s = times;
	camera.picture_count = 5;
	rb_camera_take_speed(&other, &camera);
	other.fps = 4;
	const struct rb_schedule schedule = rb_schedule_of(&other, 60, 3);
	assert_int_equal(rb_schedule_count(&schedule), 5);
	for (uint64_t k = 0; k < 5; k++)
		assert_true(rb_schedule_time(&schedule, k) == times[k]);
	assert_true(rb_schedule_step(&schedule) == 0.25);
	assert_true(rb_schedule_speed(&schedule, 1) == 1);
	assert_true(rb_schedule_speed(&schedule, 1.3) == 1);
	assert_true(rb_schedule_speed(&schedule, 1.5) == 4);
	assert_true(rb_schedule_speed(&schedule, 2.4) == 4);
	assert_true(rb_schedule_speed(&schedule, 2.75) == 1); /* of the last interval */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_camera_without_wishes_takes_a_picture_of_every_frame_to_the_bit),
		cmocka_unit_test(a_whole_number_of_intervals_is_not_lost_to_rounding),
		cmocka_unit_test(slow_motion_takes_more_pictures_and_time_lapse_fewer),
		cmocka_unit_test(the_camera_ends_with_the_run_and_no_picture_is_later),
		cmocka_unit_test(a_moment_is_one_picture_and_a_camera_after_the_end_takes_none),
		cmocka_unit_test(a_film_without_end_has_a_number_of_pictures),
		cmocka_unit_test(a_film_whose_speed_varies_has_the_times_that_were_made_for_it),
	};

	return cmocka_run_group_tests_name("schedule", tests, NULL, NULL);
}
