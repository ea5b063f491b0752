/* SPDX-License-Identifier: MIT */
/* src/control/sketch.c: where discs and lines of a frame lie, by pinhole and by parallel lines */
#include "worlds.h"

#include "control/sketch.h"
#include "flow/frame.h"
#include "math/random.h"

enum { W = 120, H = 80 };

/* Bodies before a camera at (0, -10, 0) that looks along y; x is to the right, z upwards. */
struct stage {
	struct lab lab;
	struct rb_frame frame;
	struct rb_camera_def camera;
	struct rb_pixmap picture;
};

static void open_stage(struct stage *stage)
{
	*stage = (struct stage){.camera = rb_camera_def_default()};
	lab_open(&stage->lab, 1, 10);
	stage->camera.position.value = (rb_vec3){0, -10, 0};
	stage->camera.look_at.value = (rb_vec3){0, 0, 0};
	stage->camera.fov = 2 * atan(0.5); /* from -5 to 5 at 10 m */
}

static int add_ball(struct stage *stage, rb_vec3 at, double radius, rb_vec3 colour)
{
	struct rb_body_def def = lab_sphere_def(radius, 1, at, (rb_vec3){0, 0, 0});

	rb_vec3_to(def.color, colour);
	return lab_add(&stage->lab, &def);
}

static void seal(struct stage *stage)
{
	const struct lab *lab = &stage->lab;

	if (rb_model_create(&stage->lab.model, &lab->scene, NULL, &stage->lab.error) != RB_OK)
		fail_msg("%s", lab->error.text);
	assert_int_equal(rb_frame_init(&stage->frame, lab->model, RB_FIELD_DEFAULT, NULL), RB_OK);
	for (int i = 0; i < lab->model->body_count; i++)
		rb_vec3_to(stage->frame.position + 3 * i, lab->model->position[i]);
	/* what lies behind it is watched */
	stage->picture = (struct rb_pixmap){W, H, rb_memory_take((size_t)W * H, 4)};
	assert_non_null(stage->picture.rgba);
}

static void draw(struct stage *stage)
{
	const struct rb_stand stand = rb_steer_stand(stage->lab.model, &stage->camera,
	                                             &stage->frame, NULL);
	struct rb_error err;

	assert_ok(rb_sketch_draw(&stage->picture, stage->lab.model, &stage->camera, &stand,
	                         &stage->frame, &err));
}

static void close_stage(struct stage *stage)
{
	rb_memory_free(stage->picture.rgba);
	rb_frame_release(&stage->frame);
	lab_close(&stage->lab);
}

static const uint8_t *pixel(const struct stage *stage, int x, int y)
{
	assert_true(x >= 0 && x < W && y >= 0 && y < H);
	return stage->picture.rgba + 4 * (y * W + x);
}

/* Dark and without a colour, as what nothing stands in. */
static bool is_empty(const uint8_t *p)
{
	return p[0] < 40 && p[1] < 40 && p[2] < 40;
}

static bool is_red(const uint8_t *p)
{
	return p[0] > 60 && p[1] < 20 && p[2] < 20;
}

static bool is_green(const uint8_t *p)
{
	return p[1] > 60 && p[0] < 20 && p[2] < 20;
}

static const rb_vec3 red = {1, 0, 0}, green = {0, 1, 0};

/* All pixels whose middle is in a disc and no others; at its very edge either is right. */
static void assert_disc(const struct stage *stage, double x, double y, double r)
{
	for (int j = 0; j < H; j++)
		for (int i = 0; i < W; i++) {
			const double away = hypot(i + 0.5 - x, j + 0.5 - y);

			if (fabs(away - r) < 1e-9)
				continue;
			if (is_red(pixel(stage, i, j)) != (away < r))
				fail_msg("pixel %d, %d at %g of %g", i, j, away, r);
			assert_int_equal(pixel(stage, i, j)[3], 255);
		}
}

static void a_ball_is_a_disc_where_a_pinhole_sees_it(void **state)
{
	static const rb_vec3 places[] = {{0, 0, 0}, {2, 0, 1}, {-4, 5, -3}, {0, -7, 0}, {7, 0, 0}};

	(void)state;
	for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
		const rb_vec3 at = places[k];
		struct stage stage;

		open_stage(&stage);
		add_ball(&stage, at, 0.5, red);
		seal(&stage);
		draw(&stage);
		/* 80 pixels for 10 m at 10 m */
		const double scale = 80 / (at.y + 10);
		assert_disc(&stage, 60 + scale * at.x, 40 - scale * at.z, 0.5 * scale);
		stage.camera.orthographic = true;
		stage.camera.height = 10;
		draw(&stage);
		assert_disc(&stage, 60 + 8 * at.x, 40 - 8 * at.z, 4);
		close_stage(&stage);
	}
}

static void what_is_nearer_hides_what_is_behind(void **state)
{
	struct stage stage;

	(void)state;
	for (int turn = 0; turn < 2; turn++) {
		open_stage(&stage);
		/* in the order of the scene, and in the other */
		add_ball(&stage, (rb_vec3){0, turn ? 3 : -3, 0}, 1, turn ? green : red);
		add_ball(&stage, (rb_vec3){0, turn ? -3 : 3, 0}, 1, turn ? red : green);
		seal(&stage);
		draw(&stage);
		assert_true(is_red(pixel(&stage, 60, 40)));
		for (int i = 0; i < W; i++)
			for (int j = 0; j < H; j++)
				assert_false(is_green(pixel(&stage, i, j)));
		stage.camera.position.value.y = 10; /* from the other side */
		draw(&stage);
		assert_true(is_green(pixel(&stage, 60, 40)));
		close_stage(&stage);
	}
}

static int count_drawn(const struct stage *stage)
{
	int count = 0;

	for (int i = 0; i < W * H; i++)
		count += !is_empty(stage->picture.rgba + 4 * i);
	return count;
}

static void what_cannot_be_seen_is_not_drawn(void **state)
{
	struct stage stage;

	(void)state;
	open_stage(&stage);
	struct rb_body_def def = lab_sphere_def(1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	def.visible = false;
	lab_add(&stage.lab, &def);
	add_ball(&stage, (rb_vec3){0, -20, 0}, 1, red); /* behind the eye */
	add_ball(&stage, (rb_vec3){0, -10, 0}, 1, red); /* about it */
	add_ball(&stage, (rb_vec3){100, 0, 0}, 1, red); /* beside the picture */
	add_ball(&stage, (rb_vec3){0, 0, -1000}, 1, red);
	seal(&stage);
	draw(&stage);
	assert_int_equal(count_drawn(&stage), 0);
	/* a ball that is far away is a dot: here in the middle of a pixel */
	rb_vec3_to(stage.frame.position + 3, (rb_vec3){625, 1e5, -625});
	draw(&stage);
	assert_in_range(count_drawn(&stage), 1, 4);
	close_stage(&stage);
}

/* The grid of a plane goes through what the camera looks at; every dot of it lies in that plane. */
static void a_plane_is_a_grid_of_lines(void **state)
{
	struct stage stage;
	int above = 0, below = 0;

	(void)state;
	open_stage(&stage);
	stage.camera.position.value = (rb_vec3){0, -10, 5};
	lab_plane(&stage.lab, (rb_vec3){3, 2, 0}, (rb_vec3){0, 0, 1});
	seal(&stage);
	draw(&stage);
	assert_false(is_empty(pixel(&stage, 60, 40)));
	/* lines of sight that do not go down meet it nowhere: those higher than the horizon */
	const double horizon = 40 - 80 * (5.0 / 10);
	for (int j = 0; j < H; j++)
		for (int i = 0; i < W; i++) {
			above += j + 1 < horizon && !is_empty(pixel(&stage, i, j));
			below += j > horizon && !is_empty(pixel(&stage, i, j));
		}
	assert_int_equal(above, 0);
	assert_true(below > 200 && below < W * H / 2);
	close_stage(&stage);
}

/* A wall of 4 m by 2 m, seen from before it, ends where it ends. */
static void a_rectangle_is_a_grid_of_its_size(void **state)
{
	struct stage stage;
	int left = W, right = 0, top = H, bottom = 0;

	(void)state;
	open_stage(&stage);
	lab_rectangle(&stage.lab, (rb_vec3){1, 0, -1}, (rb_vec3){0, -1, 0}, 4, 2);
	seal(&stage);
	draw(&stage);
	for (int j = 0; j < H; j++)
		for (int i = 0; i < W; i++)
			if (!is_empty(pixel(&stage, i, j))) {
				left = i < left ? i : left;
				right = i > right ? i : right;
				top = j < top ? j : top;
				bottom = j > bottom ? j : bottom;
			}
	/* from x = -1 to 3 and from z = -2 to 0, of 8 pixels each metre */
	assert_true(abs(left - 52) <= 1 && abs(right - 84) <= 1);
	assert_true(abs(top - 40) <= 1 && abs(bottom - 56) <= 1);
	/* nine lines each way: between them it is open */
	assert_true(is_empty(pixel(&stage, 54, 41)) || is_empty(pixel(&stage, 55, 42)));
	close_stage(&stage);
}

/* A line of its own between two balls, to the point of its body where it holds; none where neither is to be seen. */
static void a_spring_is_a_line_unless_both_its_ends_are_hidden(void **state)
{
	(void)state;
	for (int hidden = 0; hidden < 2; hidden++) {
		struct rb_spring_def def = rb_spring_def_default();
		struct stage stage;
		int drawn = 0, elsewhere = 0;

		open_stage(&stage);
		def.a = add_ball(&stage, (rb_vec3){-4, 0, 2}, 0.2, red);
		def.b = add_ball(&stage, (rb_vec3){4, 0, -2}, 0.2, red);
		def.at_b = (rb_vec3){0, 0, 4};
		def.stiffness = 1;
		for (int k = 0; k < 2; k++)
			stage.lab.scene.bodies[k].visible = !hidden;
		assert_int_equal(rb_scene_add_spring(&stage.lab.scene, &def, &stage.lab.error),
		                 RB_OK);
		seal(&stage);
		draw(&stage);
		/* 8 pixels a metre: along z = 2, from x = -4 to 4, but for the ball */
		for (int i = 0; i < W; i++)
			for (int j = 0; j < H; j++)
				if (!is_empty(pixel(&stage, i, j)) &&
				    !is_red(pixel(&stage, i, j))) {
					drawn += j >= 23 && j <= 24 && i >= 27 && i <= 92;
					elsewhere += j < 23 || j > 24 || i < 27 || i > 92;
				}
		assert_int_equal(elsewhere, 0);
		assert_true(hidden ? drawn == 0 : drawn >= 60);
		close_stage(&stage);
	}
}

/* From anywhere, with lines that pass by the eye: nothing is written but the picture. */
static void any_camera_draws_within_its_picture(void **state)
{
	struct stage stage;

	(void)state;
	open_stage(&stage);
	lab_plane(&stage.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	lab_rectangle(&stage.lab, (rb_vec3){0, 9, 2}, (rb_vec3){0.3, 1, 0.2}, 5, 4);
	for (int k = 0; k < 5; k++)
		add_ball(&stage, (rb_vec3){2 * k - 4, k, 1}, 0.4, red);
	seal(&stage);
	for (uint64_t k = 0; k < 400; k++) {
		double at[6];

		for (uint64_t i = 0; i < 6; i++)
			at[i] = pow(10, (double)(k % 5) - 1) * (rb_random_unit(1, k, i) - 0.5);
		stage.camera.position.value = rb_vec3_from(at);
		stage.camera.look_at.value = rb_vec3_from(at + 3);
		stage.camera.orthographic = k % 3 == 0;
		stage.camera.height = 0.1 + 10 * rb_random_unit(2, k, 0);
		draw(&stage);
		for (int i = 0; i < W * H; i++)
			assert_int_equal(stage.picture.rgba[4 * i + 3], 255);
	}
	const struct rb_stand stand = rb_steer_stand(stage.lab.model, &stage.camera, &stage.frame,
	                                             NULL);
	rb_memory_fail_at(1);
	const enum rb_status status = rb_sketch_draw(&stage.picture, stage.lab.model, &stage.camera,
	                                             &stand, &stage.frame, &stage.lab.error);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	close_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ball_is_a_disc_where_a_pinhole_sees_it),
		cmocka_unit_test(what_is_nearer_hides_what_is_behind),
		cmocka_unit_test(what_cannot_be_seen_is_not_drawn),
		cmocka_unit_test(a_plane_is_a_grid_of_lines),
		cmocka_unit_test(a_rectangle_is_a_grid_of_its_size),
		cmocka_unit_test(a_spring_is_a_line_unless_both_its_ends_are_hidden),
		cmocka_unit_test(any_camera_draws_within_its_picture),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
