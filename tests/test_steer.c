/* SPDX-License-Identifier: MIT */
/* src/control/{steer,sketch}.c: cameras that are moved by hand, and discs where bodies are. */
#include "control/steer.h"

#include "control/sketch.h"
#include "flow/frame.h"
#include "worlds.h"

static const double pi = 3.14159265358979323846;

/* A ball of 1 m at the origin that turns, and a floor below it. */
static void open_scene(struct lab *lab, struct rb_frame *frame)
{
	lab_open(lab, 1, 10);
	struct rb_body_def ball = lab_sphere_def(1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	ball.angular_velocity = (rb_vec3){1, 0, 0};
	lab_add(lab, &ball);
	assert_int_equal(rb_model_create(&lab->model, &lab->scene, NULL, &lab->error), RB_OK);
	assert_int_equal(rb_frame_init(frame, lab->model, RB_FIELD_DEFAULT, &lab->error), RB_OK);
	rb_vec3_to(frame->position, lab->model->position[0]);
	rb_quat_to(frame->orientation, lab->model->orientation[0]);
}

static struct rb_camera_def camera_at(rb_vec3 position)
{
	struct rb_camera_def camera = rb_camera_def_default();

	camera.position.value = position;
	camera.look_at.value = (rb_vec3){0, 0, 0};
	return camera;
}

static void orbits_go_round_and_end_before_the_pole(void **state)
{
	struct lab lab;
	struct rb_frame frame;

	(void)state;
	open_scene(&lab, &frame);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0});
	struct rb_stand stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	assert_vector(stand.right, ((rb_vec3){1, 0, 0}), 1e-15);
	rb_steer_orbit(&camera, &stand, pi / 2, 0);
	assert_vector(camera.position.value, ((rb_vec3){10, 0, 0}), 1e-12);
	stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	rb_steer_orbit(&camera, &stand, 0, pi / 4);
	assert_vector(camera.position.value, ((rb_vec3){sqrt(50), 0, sqrt(50)}), 1e-12);
	for (int i = 0; i < 50; i++) {
		stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
		rb_steer_orbit(&camera, &stand, 0.3, 0.3);
		assert_near(rb_vec3_length(camera.position.value), 10, 1e-9);
	}
	stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	assert_true(stand.back.z > 0.99 && stand.back.z < 1);
	assert_true(rb_vec3_finite(stand.right));
	rb_frame_release(&frame);
	lab_close(&lab);
}

static void moving_keeps_the_direction_and_zoom_the_target(void **state)
{
	struct lab lab;
	struct rb_frame frame;

	(void)state;
	open_scene(&lab, &frame);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0});
	struct rb_stand stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	rb_steer_move(&camera, &stand, (rb_vec3){1, 2, 3});
	assert_vector(camera.position.value, ((rb_vec3){1, -7, 2}), 1e-12);
	assert_vector(camera.look_at.value, ((rb_vec3){1, 3, 2}), 1e-12);
	stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	rb_steer_zoom(&camera, &stand, 2);
	assert_vector(camera.position.value, ((rb_vec3){1, -2, 2}), 1e-12);
	assert_vector(camera.look_at.value, ((rb_vec3){1, 3, 2}), 1e-12);
	rb_frame_release(&frame);
	lab_close(&lab);
}

static void a_camera_rides_on_a_body_and_follows_it(void **state)
{
	struct lab lab;
	struct rb_frame frame;

	(void)state;
	open_scene(&lab, &frame);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0});
	struct rb_stand stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	rb_steer_follow(&camera, &stand, 0);
	rb_steer_mount(&camera, &stand, 0, rb_steer_body(lab.model, &frame, 0));
	rb_vec3_to(frame.position, (rb_vec3){5, 5, 5});
	stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	assert_vector(stand.eye, ((rb_vec3){5, -5, 5}), 1e-12);
	assert_vector(stand.target, ((rb_vec3){5, 5, 5}), 1e-12);
	/* what is moved by hand stays on the body */
	rb_steer_move(&camera, &stand, (rb_vec3){0, 1, 0});
	stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	assert_vector(stand.eye, ((rb_vec3){5, -5, 6}), 1e-12);
	rb_steer_mount(&camera, &stand, -1, (rb_vec3){0, 0, 0});
	rb_steer_follow(&camera, &stand, -1);
	rb_vec3_to(frame.position, (rb_vec3){0, 0, 0});
	stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	assert_vector(stand.eye, ((rb_vec3){5, -5, 6}), 1e-12);
	assert_vector(stand.target, ((rb_vec3){5, 5, 5}), 1e-12);
	rb_frame_release(&frame);
	lab_close(&lab);
}

static void the_default_camera_sees_all_bodies(void **state)
{
	struct lab lab;
	struct rb_frame frame;

	(void)state;
	open_scene(&lab, &frame);
	const struct rb_camera_def camera = rb_steer_default(lab.model);
	const struct rb_stand stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	const double distance = rb_vec3_length(rb_vec3_sub(stand.eye, stand.target));
	assert_vector(stand.target, ((rb_vec3){0, 0, 0}), 1e-12);
	assert_true(asin(1 / distance) < camera.fov / 2);
	rb_frame_release(&frame);
	lab_close(&lab);
}

static bool is_disc(const struct rb_pixmap *picture, int x, int y)
{
	const uint8_t *const rgb = picture->rgba + 4 * (y * picture->width + x);

	return rgb[0] > 60 || rgb[1] > 60 || rgb[2] > 60;
}

static void a_sketch_has_discs_where_spheres_are(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_error err;
	uint8_t rgba[4 * 60 * 40];
	const struct rb_pixmap picture = {60, 40, rgba};

	(void)state;
	open_scene(&lab, &frame);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0});
	camera.fov = 2 * atan(0.4); /* 4 m upwards at 10 m */
	struct rb_stand stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
	assert_ok(rb_sketch_draw(&picture, lab.model, &camera, &stand, &frame, &err));
	/* 5 pixels a metre: the ball reaches from 25 to 35 */
	assert_true(is_disc(&picture, 30, 20) && is_disc(&picture, 27, 20));
	assert_false(is_disc(&picture, 23, 20) || is_disc(&picture, 37, 20));
	assert_false(is_disc(&picture, 30, 13) || is_disc(&picture, 30, 27));
	rb_vec3_to(frame.position, (rb_vec3){4, 0, 2});
	assert_ok(rb_sketch_draw(&picture, lab.model, &camera, &stand, &frame, &err));
	assert_true(is_disc(&picture, 50, 10));
	assert_false(is_disc(&picture, 30, 20));
	/* behind the eye there is nothing */
	rb_vec3_to(frame.position, (rb_vec3){0, -20, 0});
	assert_ok(rb_sketch_draw(&picture, lab.model, &camera, &stand, &frame, &err));
	for (int i = 0; i < 60 * 40; i++)
		assert_false(is_disc(&picture, i % 60, i / 60));
	rb_frame_release(&frame);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(orbits_go_round_and_end_before_the_pole),
		cmocka_unit_test(moving_keeps_the_direction_and_zoom_the_target),
		cmocka_unit_test(a_camera_rides_on_a_body_and_follows_it),
		cmocka_unit_test(the_default_camera_sees_all_bodies),
		cmocka_unit_test(a_sketch_has_discs_where_spheres_are),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
