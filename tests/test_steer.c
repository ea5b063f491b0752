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
	/* going nearer would not make anything larger */
	camera.orthographic = true;
	camera.height = 6;
	rb_steer_zoom(&camera, &stand, 2);
	assert_vector(camera.position.value, ((rb_vec3){1, -2, 2}), 1e-12);
	assert_near(camera.height, 3, 1e-15);
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

/* Of several bodies it follows the one that it was told to, and another one when it is told so. */
static void a_camera_follows_the_body_that_it_was_told_to(void **state)
{
	struct rb_frame frame;
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (int id = 0; id < 3; id++)
		lab_sphere(&lab, 1, 1, (rb_vec3){5.0 * id, id, 0}, (rb_vec3){0, 0, 0});
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_OK);
	assert_int_equal(rb_frame_init(&frame, lab.model, RB_FIELD_DEFAULT, &lab.error), RB_OK);
	for (int i = 0; i < 3; i++)
		rb_vec3_to(frame.position + 3 * i, lab.model->position[i]);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0});
	for (int k = 0; k < 6; k++) {
		const int id = (2 * k + 1) % 3;
		struct rb_stand stand = rb_steer_stand(lab.model, &camera, &frame, NULL);

		rb_steer_follow(&camera, &stand, id);
		stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
		assert_vector(stand.target, ((rb_vec3){5.0 * id, id, 0}), 1e-15);
	}
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

/* Bodies of several sizes, to one side of the origin in all directions, each seen whole; and the picture is not empty. */
static void the_default_camera_sees_bodies_wherever_they_are(void **state)
{
	static const double at[4][4] = {/* place, radius */
	                                {3, 9, -2, 0.5},
	                                {-1, 4, 5, 2},
	                                {6, 14, 1, 0.1},
	                                {2, -3, 0, 1}};

	(void)state;
	for (int turned = 0; turned < 3; turned++) {
		struct lab lab;
		struct rb_frame frame;
		double widest = 0;

		lab_open(&lab, 1, 10);
		for (int i = 0; i < 4; i++)
			lab_sphere(&lab, at[i][3], 1,
			           (rb_vec3){at[i][turned], at[i][(turned + 1) % 3],
			                     at[i][(turned + 2) % 3]},
			           (rb_vec3){0, 0, 0});
		lab_plane(&lab, (rb_vec3){0, 0, -50}, (rb_vec3){0, 0, 1});
		assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_OK);
		assert_int_equal(rb_frame_init(&frame, lab.model, RB_FIELD_DEFAULT, &lab.error),
		                 RB_OK);
		for (int i = 0; i < 4; i++)
			rb_vec3_to(frame.position + 3 * i, lab.model->position[i]);
		const struct rb_camera_def camera = rb_steer_default(lab.model);
		const struct rb_stand stand = rb_steer_stand(lab.model, &camera, &frame, NULL);
		for (int i = 0; i < 4; i++) {
			const rb_vec3 to = rb_vec3_sub(lab.model->position[i], stand.eye);
			const double length = rb_vec3_length(to);
			const double off = acos(-rb_vec3_dot(to, stand.back) / length) +
			                   asin(rb_model_reach(lab.model, i) / length);
			assert_true(off < camera.fov / 2);
			widest = fmax(widest, off);
		}
		assert_true(widest > camera.fov / 5);
		rb_frame_release(&frame);
		lab_close(&lab);
	}
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
	/* along parallel lines of sight all have their size: 40 pixels for 8 m */
	camera.orthographic = true;
	camera.height = 8;
	for (int k = 0; k < 3; k++) {
		rb_vec3_to(frame.position, (rb_vec3){2, 40.0 * (k - 1), 1});
		assert_ok(rb_sketch_draw(&picture, lab.model, &camera, &stand, &frame, &err));
		assert_true(is_disc(&picture, 40, 15) && is_disc(&picture, 37, 15));
		assert_false(is_disc(&picture, 33, 15) || is_disc(&picture, 47, 15));
		assert_false(is_disc(&picture, 40, 8) || is_disc(&picture, 40, 22));
	}
	rb_frame_release(&frame);
	lab_close(&lab);
}

/* 60 x 40 pixels seen from 10 m before the origin, 5 of them a metre there. */
static void draw(const struct lab *lab, const struct rb_frame *frame, uint8_t *rgba)
{
	const struct rb_pixmap picture = {60, 40, rgba};
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0});
	struct rb_error err;

	camera.fov = 2 * atan(0.4);
	const struct rb_stand stand = rb_steer_stand(lab->model, &camera, frame, NULL);
	assert_ok(rb_sketch_draw(&picture, lab->model, &camera, &stand, frame, &err));
}

static void a_disc_is_round_and_darker_to_its_rim(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	uint8_t rgba[4 * 60 * 40];

	(void)state;
	lab_open(&lab, 1, 10);
	struct rb_body_def ball = lab_sphere_def(2, 1, (rb_vec3){1, 0, -1}, (rb_vec3){0, 0, 0});
	for (int k = 0; k < 3; k++)
		ball.color[k] = 1;
	lab_add(&lab, &ball);
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_OK);
	assert_int_equal(rb_frame_init(&frame, lab.model, RB_FIELD_DEFAULT, &lab.error), RB_OK);
	rb_vec3_to(frame.position, lab.model->position[0]);
	draw(&lab, &frame, rgba);
	/* its middle lies between pixels, at 35, 25; the radius is 10 pixels */
	double before = 256;
	for (int square = 0; square <= 100; square++)
		for (int y = 0; y < 40; y++)
			for (int x = 0; x < 60; x++) {
				const double dx = x + 0.5 - 35, dy = y + 0.5 - 25;
				const uint8_t value = rgba[4 * (60 * y + x)];
				if ((int)(dx * dx + dy * dy) != square)
					continue;
				if (square == 100)
					continue; /* the rim itself */
				assert_true(value <= before && value > 255 * 0.4);
				/* all eight pixels at that distance are the same */
				const int a = (int)(fabs(dx) - 0.5), b = (int)(fabs(dy) - 0.5);
				assert_int_equal(value, rgba[4 * (60 * (25 + a) + 35 + b)]);
				if (a > b)
					before = value;
			}
	assert_true(rgba[4 * (60 * 25 + 35)] > 250 && before < 255 * 0.5);
	for (int i = 0; i < 60 * 40; i++) {
		const double dx = i % 60 + 0.5 - 35, dy = (int)(i / 60) + 0.5 - 25;
		if (dx * dx + dy * dy > 101)
			assert_true(rgba[4 * i] < 60);
	}
	rb_frame_release(&frame);
	lab_close(&lab);
}

static bool is_line(const uint8_t *rgba, int x, int y)
{
	return rgba[4 * (60 * y + x)] == 110;
}

/* A square of 4 m that faces the eye is 20 pixels wide, with nine lines each way. */
static void a_rectangle_is_a_grid_from_edge_to_edge(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	uint8_t rgba[4 * 60 * 40];

	(void)state;
	lab_open(&lab, 1, 10);
	lab_sphere(&lab, 0.01, 1, (rb_vec3){0, 0, -3}, (rb_vec3){0, 0, 0});
	lab_rectangle(&lab, (rb_vec3){1, 0, 0.6}, (rb_vec3){0, -1, 0}, 4, 4);
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_OK);
	assert_int_equal(rb_frame_init(&frame, lab.model, RB_FIELD_DEFAULT, &lab.error), RB_OK);
	rb_vec3_to(frame.position, lab.model->position[0]);
	draw(&lab, &frame, rgba);
	for (int i = 0; i < 60 * 40; i++) {
		const int x = i % 60, y = i / 60;
		if (x < 24 || x > 45 || y < 6 || y > 27)
			assert_false(is_line(rgba, x, y));
	}
	for (int i = 7; i < 27; i++) { /* the four edges, without gaps */
		assert_true(is_line(rgba, 24, i) || is_line(rgba, 25, i));
		assert_true(is_line(rgba, 44, i) || is_line(rgba, 45, i));
		assert_true(is_line(rgba, i + 18, 6) || is_line(rgba, i + 18, 7));
		assert_true(is_line(rgba, i + 18, 26) || is_line(rgba, i + 18, 27));
	}
	rb_frame_release(&frame);
	lab_close(&lab);
}

/*
 * A floor 2 m below the line of sight: what lies y metres behind the eye's target is at 10 + y, and so 100 / (10 + y)
 * pixels below the horizon. The grid goes 10 m to each side of the target, in steps of 2.5 m; half of it is behind the eye.
 */
static void a_floor_is_a_grid_that_ends_below_the_horizon(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	uint8_t rgba[4 * 60 * 40];

	(void)state;
	lab_open(&lab, 1, 10);
	lab_sphere(&lab, 0.01, 1, (rb_vec3){0, 0, 3}, (rb_vec3){0, 0, 0});
	lab_plane(&lab, (rb_vec3){7, 3, -2}, (rb_vec3){0, 0, 1});
	assert_int_equal(rb_model_create(&lab.model, &lab.scene, NULL, &lab.error), RB_OK);
	assert_int_equal(rb_frame_init(&frame, lab.model, RB_FIELD_DEFAULT, &lab.error), RB_OK);
	rb_vec3_to(frame.position, lab.model->position[0]);
	draw(&lab, &frame, rgba);
	for (int x = 0; x < 60; x++) {
		for (int y = 0; y < 24; y++)
			assert_false(is_line(rgba, x, y));
		if (x >= 6 && x < 54) /* its far end, 20 m from the eye */
			assert_true(is_line(rgba, x, 24) || is_line(rgba, x, 25));
		/* no line across is near row 37: those along it are 50 * 2.5 / (100 / 17.5) apart */
		const double away = fabs(x + 0.5 - 30);
		const bool near = away < 1.6 || fabs(away - 21.9) < 1.6;
		assert_true(near || !is_line(rgba, x, 37));
	}
	assert_true(is_line(rgba, 29, 37) || is_line(rgba, 30, 37));
	assert_true(is_line(rgba, 51, 37) || is_line(rgba, 52, 37));
	assert_true(is_line(rgba, 7, 37) || is_line(rgba, 8, 37));
	rb_frame_release(&frame);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(orbits_go_round_and_end_before_the_pole),
		cmocka_unit_test(moving_keeps_the_direction_and_zoom_the_target),
		cmocka_unit_test(a_camera_rides_on_a_body_and_follows_it),
		cmocka_unit_test(a_camera_follows_the_body_that_it_was_told_to),
		cmocka_unit_test(the_default_camera_sees_all_bodies),
		cmocka_unit_test(the_default_camera_sees_bodies_wherever_they_are),
		cmocka_unit_test(a_sketch_has_discs_where_spheres_are),
		cmocka_unit_test(a_disc_is_round_and_darker_to_its_rim),
		cmocka_unit_test(a_rectangle_is_a_grid_from_edge_to_edge),
		cmocka_unit_test(a_floor_is_a_grid_that_ends_below_the_horizon),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
