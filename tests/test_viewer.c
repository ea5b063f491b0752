/* SPDX-License-Identifier: MIT */
/* src/control/viewer.c, source.c: over a run's socket; time is handed in, nothing here waits */
#include "host.h"

#include "base/clock.h"
#include "control/orders.h"
#include "control/viewer.h"

static const uint64_t picture_ns = 33333334;

/* A viewer of a host's run, which has made its first frame. */
struct seat {
	struct host host;
	struct rb_client *client;
	struct rb_source *source;
	struct rb_viewer *viewer;
	uint64_t now_ns;
};

static void sit_down(struct seat *seat, bool live)
{
	struct rb_error *const err = &seat->host.err;

	open_host(&seat->host);
	keep_frame(&seat->host, 0);
	seat->now_ns = rb_clock_now_ns();
	assert_good(*err, rb_client_connect(&seat->client, seat->host.path, 10, err));
	assert_good(*err,
	            rb_source_of_run(&seat->source, seat->client, NULL, seat->host.lab.model, err));
	const struct rb_viewer_options options = {.source = seat->source,
	                                          .model = seat->host.lab.model,
	                                          .name = "s",
	                                          .fps = 30,
	                                          .speed = 1,
	                                          .live = live};
	assert_good(*err, rb_viewer_create(&seat->viewer, &options, seat->now_ns, err));
	rb_viewer_tick(seat->viewer, seat->now_ns);
	assert_true(seat->viewer->has_frame);
}

static void leave(struct seat *seat)
{
	rb_viewer_destroy(seat->viewer);
	rb_source_destroy(seat->source);
	rb_client_close(seat->client);
	close_host(&seat->host);
}

static void tick(struct seat *seat, uint64_t by_ns)
{
	seat->now_ns += by_ns;
	rb_viewer_tick(seat->viewer, seat->now_ns);
	rb_viewer_shown(seat->viewer, seat->now_ns);
}

static void a_live_view_has_the_newest_frame_in_each_picture(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, true);
	for (uint64_t k = 1; k < 40; k++) {
		keep_frame(&seat.host, k);
		tick(&seat, picture_ns);
		assert_int_equal(seat.viewer->row, k);
		assert_near(seat.viewer->frame.position[0], (double)k, 1e-6);
	}
	leave(&seat);
}

static void a_look_tells_whether_there_is_anything_new(void **state)
{
	struct seat seat = {0};
	struct rb_error *const err = &seat.host.err;
	bool changed = true;

	(void)state;
	sit_down(&seat, true);
	for (uint64_t k = 1; k < 4; k++) {
		assert_good(*err, rb_source_refresh(seat.source, seat.now_ns, true, &changed, err));
		assert_false(changed);
		keep_frame(&seat.host, k);
		assert_good(*err, rb_source_refresh(seat.source, seat.now_ns, true, &changed, err));
		assert_true(changed);
	}
	/* too early for another look */
	assert_good(*err, rb_source_refresh(seat.source, seat.now_ns, false, &changed, err));
	assert_false(changed);
	leave(&seat);
}

static void a_view_that_waits_for_the_run_shows_its_next_frame_at_once(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, false);
	/* a tenth of a second a frame: each is late by a picture */
	for (uint64_t k = 1; k < 20; k++) {
		tick(&seat, 100000000);
		assert_int_equal(seat.viewer->row, k - 1);
		keep_frame(&seat.host, k);
		tick(&seat, picture_ns);
		assert_int_equal(seat.viewer->row, k);
	}
	leave(&seat);
}

/* The run was held up for a second: what it then makes at once is not skipped to make up for that. */
static void after_a_wait_time_goes_on_from_the_frame_that_came(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, false);
	for (int i = 0; i < 20; i++)
		tick(&seat, 50000000);
	for (uint64_t k = 1; k < 8; k++)
		keep_frame(&seat.host, k);
	tick(&seat, 1000000);
	assert_int_equal(seat.viewer->row, 1);
	for (uint64_t k = 2; k < 8; k++) { /* a tenth of a second a frame */
		tick(&seat, 80000000);
		assert_int_equal(seat.viewer->row, k - 1);
		tick(&seat, 20000000);
		assert_int_equal(seat.viewer->row, k);
	}
	leave(&seat);
}

static void a_step_of_the_run_is_shown_with_the_next_picture(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, false);
	assert_int_equal(rb_order(seat.viewer, "pause", seat.now_ns), RB_OK);
	tick(&seat, picture_ns);
	assert_int_equal(rb_order(seat.viewer, "step 2", seat.now_ns), RB_OK);
	tick(&seat, picture_ns);
	keep_frame(&seat.host, 1);
	tick(&seat, picture_ns);
	assert_int_equal(seat.viewer->row, 1);
	keep_frame(&seat.host, 2);
	tick(&seat, picture_ns);
	assert_int_equal(seat.viewer->row, 2);
	assert_false(seat.viewer->has_goal);
	leave(&seat);
}

/* Another client's step ends between two looks at the run's state: what is meant by toggle is play. */
static void toggle_goes_by_what_the_run_does_now(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, true);
	rb_player_attend(seat.host.player, true);
	tick(&seat, 1000000000);
	assert_string_equal(rb_viewer_state(seat.viewer), "live");
	rb_player_step(seat.host.player, 1);
	keep_frame(&seat.host, 1);
	tick(&seat, picture_ns);
	assert_int_equal(seat.viewer->row, 1);
	assert_int_equal(rb_order(seat.viewer, "toggle", seat.now_ns), RB_OK);
	assert_false(rb_player_status(seat.host.player).pausing);
	assert_int_equal(rb_order(seat.viewer, "toggle", seat.now_ns), RB_OK);
	assert_true(rb_player_status(seat.host.player).pausing);
	leave(&seat);
}

static double apart(rb_vec3 a, rb_vec3 b)
{
	return rb_vec3_length(rb_vec3_sub(a, b));
}

/* Angles are degrees; a way is to the right, up and forward. */
static void a_camera_is_moved_as_it_is_told(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, false);
	struct rb_camera_def *const camera = &seat.viewer->camera;
	const rb_vec3 *const eye = &camera->position.value, *const target = &camera->look_at.value;
	rb_vec3 was = *eye;
	assert_false(seat.viewer->camera_moved);
	assert_int_equal(rb_order(seat.viewer, "camera orbit 20 0", seat.now_ns), RB_OK);
	assert_true(seat.viewer->camera_moved);
	const double across = hypot(was.x - target->x, was.y - target->y);
	assert_near(eye->z, was.z, 1e-12);
	assert_near(hypot(eye->x - target->x, eye->y - target->y), across, 1e-12 * across);
	assert_near(apart(*eye, was), 2 * across * sin(10 * 3.14159265358979323846 / 180),
	            1e-12 * across);
	was = *eye;
	assert_int_equal(rb_order(seat.viewer, "camera orbit 0 10", seat.now_ns), RB_OK);
	assert_true(eye->z > was.z);
	assert_near(apart(*eye, *target), apart(was, *target), 1e-12 * across);
	was = *eye;
	assert_int_equal(rb_order(seat.viewer, "camera zoom 2", seat.now_ns), RB_OK);
	assert_near(apart(*eye, *target), 0.5 * apart(was, *target), 1e-12 * across);
	assert_int_equal(rb_order(seat.viewer, "camera mount c", seat.now_ns), RB_OK);
	assert_int_equal(camera->mount, 2);
	assert_int_equal(rb_order(seat.viewer, "camera mount", seat.now_ns), RB_OK);
	assert_int_equal(camera->mount, -1);
	assert_int_equal(rb_order(seat.viewer, "camera mount nobody", seat.now_ns), RB_ERR_USAGE);
	const rb_vec3 eyes[2] = {*eye, *target};
	assert_int_equal(rb_order(seat.viewer, "camera move 1 2 3", seat.now_ns), RB_OK);
	assert_near(apart(*eye, eyes[0]), sqrt(14), 1e-12);
	assert_near(apart(rb_vec3_sub(*eye, eyes[0]), rb_vec3_sub(*target, eyes[1])), 0, 1e-12);
	leave(&seat);
}

/* Whether the body with this id is in the middle square of a picture. */
static bool is_seen(const struct seat *seat, int id)
{
	const struct rb_viewer *const viewer = seat->viewer;
	const struct rb_stand stand = rb_viewer_stand(viewer);
	const rb_vec3 arm = rb_vec3_sub(rb_steer_body(viewer->options.model, &viewer->frame, id),
	                                stand.eye);
	const double most = -rb_vec3_dot(arm, stand.back) * tan(0.5 * viewer->camera.fov);

	return fabs(rb_vec3_dot(arm, stand.right)) < most &&
	       fabs(rb_vec3_dot(arm, stand.up)) < most;
}

/* Until it is moved by hand, and again when all is to be shown. */
static void a_camera_without_a_position_keeps_all_that_moves_in_the_picture(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, true);
	for (uint64_t k = 1; k < 40; k++) {
		keep_frame(&seat.host, k);
		tick(&seat, picture_ns);
		assert_true(is_seen(&seat, 0));
		if (k == 20) {
			assert_int_equal(rb_order(seat.viewer, "camera zoom 50", seat.now_ns),
			                 RB_OK);
			assert_false(is_seen(&seat, 0));
			assert_int_equal(rb_order(seat.viewer, "camera all", seat.now_ns), RB_OK);
			assert_true(is_seen(&seat, 0));
		}
	}
	assert_int_equal(rb_order(seat.viewer, "camera all of it", seat.now_ns), RB_ERR_USAGE);
	leave(&seat);
}

static void only_what_is_new_is_counted_as_drawn(void **state)
{
	struct seat seat = {0};

	(void)state;
	sit_down(&seat, true);
	tick(&seat, picture_ns);
	const uint64_t before = seat.viewer->drawn_count;
	for (int i = 0; i < 5; i++)
		tick(&seat, picture_ns);
	assert_int_equal(seat.viewer->drawn_count, before);
	keep_frame(&seat.host, 1);
	tick(&seat, picture_ns);
	assert_int_equal(seat.viewer->drawn_count, before + 1);
	leave(&seat);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_live_view_has_the_newest_frame_in_each_picture),
		cmocka_unit_test(a_camera_without_a_position_keeps_all_that_moves_in_the_picture),
		cmocka_unit_test(a_look_tells_whether_there_is_anything_new),
		cmocka_unit_test(a_view_that_waits_for_the_run_shows_its_next_frame_at_once),
		cmocka_unit_test(after_a_wait_time_goes_on_from_the_frame_that_came),
		cmocka_unit_test(a_step_of_the_run_is_shown_with_the_next_picture),
		cmocka_unit_test(toggle_goes_by_what_the_run_does_now),
		cmocka_unit_test(a_camera_is_moved_as_it_is_told),
		cmocka_unit_test(only_what_is_new_is_counted_as_drawn),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
