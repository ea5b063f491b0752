/* SPDX-License-Identifier: MIT */
/* src/film/view.c: where cameras stand, against numbers worked out by hand. */
#include "film/view.h"

#include "flow/frame.h"
#include "worlds.h"

static void seal(struct lab *lab, struct rb_frame *frame)
{
	assert_int_equal(rb_model_create(&lab->model, &lab->scene, NULL, &lab->error), RB_OK);
	assert_int_equal(rb_frame_init(frame, lab->model, RB_FIELD_DEFAULT, &lab->error), RB_OK);
	for (int i = 0; i < lab->model->body_count; i++) {
		rb_vec3_to(frame->position + 3 * i, lab->model->position[i]);
		if (frame->orientation)
			rb_quat_to(frame->orientation + 4 * i, lab->model->orientation[i]);
	}
}

static void unseal(struct lab *lab, struct rb_frame *frame)
{
	rb_frame_release(frame);
	lab_close(lab);
}

static struct rb_camera_def camera_at(rb_vec3 position, rb_vec3 look_at)
{
	struct rb_camera_def camera = rb_camera_def_default();

	camera.name = "main";
	camera.line = 7;
	camera.position.value = position;
	camera.look_at.value = look_at;
	return camera;
}

/* One ball of 0.5 m at the origin. */
static void open_ball(struct lab *lab, struct rb_frame *frame)
{
	lab_open(lab, 1, 10);
	struct rb_body_def ball = lab_sphere_def(0.5, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	ball.angular_velocity = (rb_vec3){1, 0, 0};
	lab_add(lab, &ball);
	seal(lab, frame);
}

static void a_camera_before_the_origin_sees_x_to_the_right_and_z_upwards(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;
	double pixel[2];

	(void)state;
	open_ball(&lab, &frame);
	const struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0}, (rb_vec3){0, 0, 0});
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	assert_vector(view.right, ((rb_vec3){1, 0, 0}), 1e-15);
	assert_vector(view.up, ((rb_vec3){0, 0, 1}), 1e-15);
	assert_vector(view.back, ((rb_vec3){0, -1, 0}), 1e-15);
	assert_vector(rb_view_point(&view, (rb_vec3){1, 2, 3}), ((rb_vec3){1, 3, -12}), 1e-14);
	/* tan(pi/8) = sqrt(2) - 1 is half the picture's height at distance 1. */
	rb_view_pixel(&view, (rb_vec3){1, 0, -10}, pixel);
	assert_near(pixel[0], 640 + 0.1 / (sqrt(2) - 1) * 360, 1e-9);
	assert_near(pixel[1], 360, 1e-9);
	rb_view_pixel(&view, (rb_vec3){0, 2, -10}, pixel);
	assert_near(pixel[0], 640, 1e-9);
	assert_near(pixel[1], 360 - 0.2 / (sqrt(2) - 1) * 360, 1e-9);
	unseal(&lab, &frame);
}

static void transform(const float m[16], rb_vec3 p, double clip[4])
{
	for (int r = 0; r < 4; r++)
		clip[r] = (double)m[r] * p.x + (double)m[4 + r] * p.y + (double)m[8 + r] * p.z +
		          (double)m[12 + r];
}

static void the_projection_agrees_with_pixels_and_depth(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;
	const rb_vec3 point = {0.7, -0.4, -6};
	double pixel[2], a, b, clip[4];
	float matrix[16];

	(void)state;
	open_ball(&lab, &frame);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0}, (rb_vec3){0, 0, 0});
	for (int far = 0; far < 2; far++) {
		camera.near = 2;
		camera.far = far ? 20 : (double)NAN;
		assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
		rb_view_depth(&view, &a, &b);
		assert_near(a + b / 2, 1, 1e-15);
		assert_near(far ? a + b / 20 : a, 0, 1e-15);
		rb_view_pixel(&view, point, pixel);
		for (int zero = 0; zero < 2; zero++) {
			rb_view_projection(&view, zero, matrix);
			transform(matrix, point, clip);
			/* y downwards: row 0 of the window is the top of the picture */
			assert_near((clip[0] / clip[3] + 1) / 2 * 1280, pixel[0], 1e-3);
			assert_near((clip[1] / clip[3] + 1) / 2 * 720, pixel[1], 1e-3);
			const double z = clip[2] / clip[3];
			assert_near(zero ? z : (z + 1) / 2, a + b / 6, 1e-6);
		}
	}
	unseal(&lab, &frame);
}

static void a_frustum_is_taken_as_it_is(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;
	double pixel[2];

	(void)state;
	open_ball(&lab, &frame);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0}, (rb_vec3){0, 0, 0});
	const double frustum[6] = {-0.2, 0.6, -0.1, 0.3, 2, 50};
	memcpy(camera.frustum, frustum, sizeof frustum);
	camera.has_frustum = true;
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	assert_near(view.near, 2, 0);
	assert_near(view.far, 50, 0);
	/* The corner (0.6, 0.3) of the near plane is the picture's upper right one, seen at any distance. */
	rb_view_pixel(&view, (rb_vec3){0.9, 0.45, -3}, pixel);
	assert_near(pixel[0], 1280, 1e-9);
	assert_near(pixel[1], 0, 1e-9);
	unseal(&lab, &frame);
}

static void cameras_follow_bodies_and_ride_on_them(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;

	(void)state;
	open_ball(&lab, &frame);
	rb_vec3_to(frame.position, (rb_vec3){5, 0, 1});
	/* A quarter turn about z: the body's x points along the world's y. */
	rb_quat_to(frame.orientation, rb_quat_from_turn((rb_vec3){0, 0, acos(-1) / 2}));
	struct rb_camera_def camera = camera_at((rb_vec3){5, -10, 1}, (rb_vec3){0, 0, 0});
	camera.look_at.source = RB_CAMERA_BODY;
	camera.look_at.body = 0;
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	assert_vector(view.back, ((rb_vec3){0, -1, 0}), 1e-15);

	camera.mount = 0;
	camera.offset = (rb_vec3){2, 0, 0};
	camera.look_at.source = RB_CAMERA_FIXED;
	camera.look_at.value = (rb_vec3){5, 100, 1};
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	assert_vector(view.eye, ((rb_vec3){5, 2, 1}), 1e-14);
	camera.level = true;
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	assert_vector(view.eye, ((rb_vec3){7, 0, 1}), 1e-14);

	/* Half a turn about y: upside down, unless it stays level. */
	rb_quat_to(frame.orientation, rb_quat_from_turn((rb_vec3){0, acos(-1), 0}));
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	assert_true(view.up.z > 0.9);
	camera.level = false;
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	assert_true(view.up.z < -0.9);
	unseal(&lab, &frame);
}

static void functions_of_time_speak_through_shots(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;

	(void)state;
	open_ball(&lab, &frame);
	struct rb_camera_def camera = camera_at((rb_vec3){0, -10, 0}, (rb_vec3){0, 0, 0});
	camera.position.source = RB_CAMERA_FUNCTION;
	const struct rb_frame_shot shot = {.position = {8, 0, 0}, .look_at = {9, 9, 9}};
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, &shot, &err));
	assert_vector(view.eye, ((rb_vec3){8, 0, 0}), 0);
	/* look_at is fixed: what the shot says of it does not count. */
	assert_vector(view.back, ((rb_vec3){1, 0, 0}), 1e-15);
	unseal(&lab, &frame);
}

static void what_cannot_be_seen_from_is_refused_by_name(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;

	(void)state;
	lab_open(&lab, 1, 10);
	struct rb_body_def ball = lab_sphere_def(0.5, 1, (rb_vec3){0, 0, 1}, (rb_vec3){0, 0, 0});
	ball.name = "glass";
	lab_add(&lab, &ball);
	ball.visible = false;
	ball.name = "ghost";
	ball.position = (rb_vec3){4, 0, 1};
	lab_add(&lab, &ball);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	seal(&lab, &frame);
	frame.time_s = 0.25;

	struct rb_camera_def camera = camera_at((rb_vec3){0.1, 0, 1.2}, (rb_vec3){5, 5, 5});
	assert_int_equal(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "'main'"));
	assert_non_null(strstr(err.text, "'glass'"));
	assert_non_null(strstr(err.text, "0.25"));
	camera.position.value = (rb_vec3){4, 0, 1};
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	camera.position.value = (rb_vec3){0, -9, -0.01};
	assert_ok(
		rb_view_make(&view, lab.model, &camera, &frame, NULL, &err)); /* behind the floor */
	camera.position.value = camera.look_at.value;
	assert_int_equal(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "'look_at'"));
	camera.position.value = (rb_vec3){5, 5, 9};
	assert_int_equal(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err), RB_ERR_SCENE);
	assert_non_null(strstr(err.text, "'up'"));
	unseal(&lab, &frame);
}

static void nothing_near_is_cut_off_and_nothing_far(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;

	(void)state;
	for (int power = -6; power <= 6; power += 3) {
		const double s = pow(10, power);
		lab_open(&lab, 1, 10);
		lab_sphere(&lab, 0.5 * s, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
		seal(&lab, &frame);
		struct rb_camera_def camera = camera_at((rb_vec3){0, -0.501 * s, 0},
		                                        (rb_vec3){0, 0, 0});
		assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
		assert_true(view.near > 0 && view.near < 0.001 * s);
		assert_true(isinf(view.far));
		unseal(&lab, &frame);
	}
}

static void a_million_metres_away_the_view_is_the_same(void **state)
{
	struct lab lab;
	struct rb_frame frame;
	struct rb_view view;
	struct rb_error err;
	const rb_vec3 far = {1048576, -2097152, 524288}; /* powers of two: exact shifts */

	(void)state;
	lab_open(&lab, 1, 10);
	lab_sphere(&lab, 0.5, 1, far, (rb_vec3){0, 0, 0});
	seal(&lab, &frame);
	const struct rb_camera_def camera = camera_at(rb_vec3_add(far, (rb_vec3){0, -10, 0}), far);
	assert_ok(rb_view_make(&view, lab.model, &camera, &frame, NULL, &err));
	const rb_vec3 point = rb_vec3_add(far, (rb_vec3){0.25, 0.5, -0.125});
	assert_vector(rb_view_point(&view, point), ((rb_vec3){0.25, -0.125, -10.5}), 1e-14);
	unseal(&lab, &frame);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_camera_before_the_origin_sees_x_to_the_right_and_z_upwards),
		cmocka_unit_test(the_projection_agrees_with_pixels_and_depth),
		cmocka_unit_test(a_frustum_is_taken_as_it_is),
		cmocka_unit_test(cameras_follow_bodies_and_ride_on_them),
		cmocka_unit_test(functions_of_time_speak_through_shots),
		cmocka_unit_test(what_cannot_be_seen_from_is_refused_by_name),
		cmocka_unit_test(nothing_near_is_cut_off_and_nothing_far),
		cmocka_unit_test(a_million_metres_away_the_view_is_the_same),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
