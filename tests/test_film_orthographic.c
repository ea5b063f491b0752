/* SPDX-License-Identifier: MIT */
/* src/film/view.c, src/film/shaders.c and who draws with them: parallel lines of sight. */
#include "film/view.h"

#include "flow/framing.h"
#include "math/quat.h"
#include "studio.h"

static const double paper[3] = {1, 1, 1};

/* A picture `height` metres high, straight along y. */
static void open_straight(struct studio *studio, double height)
{
	studio_open(studio);
	memcpy(studio->camera.background, paper, sizeof paper);
	studio->camera.orthographic = true;
	studio->camera.height = height;
	studio->camera.position.value = (rb_vec3){0, -10, 0};
	studio->camera.look_at.value = (rb_vec3){0, 0, 0};
}

static bool is_paper(const uint8_t *p)
{
	return brightness(p) == 3 * 255;
}

static void a_ball_is_a_disc_of_its_radius_at_any_depth(void **state)
{
	/* in front of the camera, in it, and behind: lines of sight have no end */
	static const double depths[6] = {-8, 0, 100, 1e4, -10, -500};
	const double height = 6, px = HEIGHT / height, radius = 1.1, pi = acos(-1);

	(void)state;
	for (int k = 0; k < 24; k++) {
		struct studio studio;
		double sum = 0, x = 0, z = 0;
		open_straight(&studio, height);
		studio.camera.samples = k / 6 % 2 == 0 ? 1 : 4;
		if (k >= 12) /* exact spheres have depths of their own */
			studio.camera.far = 1e5;
		studio_ball(&studio, radius, (rb_vec3){1.3, depths[k % 6], -0.7}, red);
		studio_seal(&studio);
		studio_draw(&studio);
		for (int j = 0; j < HEIGHT; j++)
			for (int i = 0; i < WIDTH; i++) {
				const double a = i + 0.5 - WIDTH / 2.0 - 1.3 * px;
				const double b = j + 0.5 - HEIGHT / 2.0 - 0.7 * px;
				const double off = hypot(a, b) / px;
				const bool drawn = !is_paper(pixel_at(&studio, i, j));
				if (fabs(off - radius) * px > 1.5)
					assert_int_equal(drawn, off < radius);
				sum += drawn;
				x += drawn * (i + 0.5);
				z += drawn * (j + 0.5);
			}
		assert_near(x / sum, WIDTH / 2.0 + 1.3 * px, 0.1);
		assert_near(z / sum, HEIGHT / 2.0 + 0.7 * px, 0.1);
		/* soft edges touch pixels of which they cover a part only */
		const double r = radius * px;
		assert_true(sum > pi * (r - 0.1) * (r - 0.1) && sum < pi * (r + 1) * (r + 1));
		studio_close(&studio);
	}
}

/* Each pixel shows the nearest of many balls. */
static void what_is_nearer_hides_what_is_farther(void **state)
{
	enum { BALLS = 150 };
	const double px = HEIGHT / 6.0;

	(void)state;
	for (int way = 0; way < 4; way++) {
		struct studio studio;
		rb_vec3 at[BALLS];
		uint32_t seed = 12345;
		int reds = 0, blues = 0;
		open_straight(&studio, 6);
		studio.camera.samples = way % 2 == 0 ? 1 : 4;
		if (way >= 2)
			studio.camera.near = 5, studio.camera.far = 1000;
		for (int k = 0; k < BALLS; k++) {
			double part[3];
			for (int c = 0; c < 3; c++) {
				seed = seed * 1664525u + 1013904223u;
				part[c] = (seed >> 8) / 16777216.0 - 0.5;
			}
			/* one behind the other, so that none cut each other */
			at[k] = (rb_vec3){7 * part[0], 1.2 * k + 0.1 * part[1], 6 * part[2]};
			studio_ball(&studio, 0.5, at[k], k % 2 ? red : blue);
		}
		studio_seal(&studio);
		studio_draw(&studio);
		for (int j = 0; j < HEIGHT; j++)
			for (int i = 0; i < WIDTH; i++) {
				const double x = (i + 0.5 - WIDTH / 2.0) / px;
				const double z = (HEIGHT / 2.0 - j - 0.5) / px;
				const uint8_t *p = pixel_at(&studio, i, j);
				int first = -1;
				bool edge = false;
				for (int k = 0; k < BALLS && first < 0; k++) {
					const double off = hypot(x - at[k].x, z - at[k].z) - 0.5;
					edge |= fabs(off) * px < 1.5;
					first = off < 0 ? k : -1;
				}
				if (edge)
					continue;
				if (first < 0)
					assert_true(is_paper(p));
				else
					assert_true(first % 2 ? p[0] > p[2] : p[2] > p[0]);
				reds += first >= 0 && first % 2;
				blues += first >= 0 && first % 2 == 0;
			}
		assert_true(reds > 2000 && blues > 2000);
		studio_close(&studio);
	}
}

/* From where to where a row of the picture is drawn. */
static void extent(const struct studio *studio, int y, int range[2])
{
	range[0] = WIDTH;
	range[1] = -1;
	for (int x = 0; x < WIDTH; x++)
		if (!is_paper(pixel_at(studio, x, y))) {
			range[0] = x < range[0] ? x : range[0];
			range[1] = x;
		}
}

/* A beam that goes away from the viewer is as wide at its far end, in every style. */
static void parallel_edges_stay_parallel(void **state)
{
	(void)state;
	for (int way = 0; way < 2; way++) {
		struct studio studio;
		struct rb_body_def def = rb_body_def_default();
		int range[2];
		open_straight(&studio, 6);
		studio.camera.wireframe = way == 1;
		studio.camera.position.value = (rb_vec3){0, -10, 10};
		def.call = "box";
		def.shape = (struct rb_shape){.kind = RB_SHAPE_BOX, .size = {2, 6, 0.4}};
		def.mass = 1;
		def.filters = true;
		rb_vec3_to(def.color, red);
		lab_add(&studio.lab, &def);
		studio_seal(&studio);
		studio_draw(&studio);
		/* 20 pixels a metre: from -1 m to 1 m; its length, 6 m, and its height by sin and cos of 45 degrees */
		for (int y = 20; y < 100; y++) {
			extent(&studio, y, range);
			assert_in_range(range[0], WIDTH / 2 - 22, WIDTH / 2 - 19);
			assert_in_range(range[1], WIDTH / 2 + 18, WIDTH / 2 + 21);
		}
		const int half = (int)(20 * (3 + 0.2) * sqrt(0.5));
		extent(&studio, HEIGHT / 2 - half - 3, range);
		assert_true(range[1] < 0);
		extent(&studio, HEIGHT / 2 + half + 3, range);
		assert_true(range[1] < 0);
		studio_close(&studio);
	}
}

/* Squares of a floor seen from above are as large everywhere, and it ends nowhere; edge-on it is not seen. */
static void a_floor_fills_the_picture_unless_it_is_seen_edge_on(void **state)
{
	static const rb_vec3 places[4] = {{0, 0, 9}, {0, -9, 9}, {0, -9, 0.01}, {0, -9, 0}};

	(void)state;
	for (int k = 0; k < 4; k++) {
		struct studio studio;
		open_straight(&studio, 20);
		studio.camera.position.value = places[k];
		if (k == 0)
			studio.camera.up.value = (rb_vec3){0, 1, 0};
		studio_ball(&studio, 0.5, (rb_vec3){0, 0, 0.5}, red);
		lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		studio_seal(&studio);
		studio_draw(&studio);
		for (int i = 0; i < WIDTH * HEIGHT; i++) {
			const bool drawn = !is_paper(pixel_at(&studio, i % WIDTH, i / WIDTH));
			if (k < 3)
				assert_true(drawn);
			else if (hypot(i % WIDTH - WIDTH / 2.0, i / WIDTH - HEIGHT / 2.0) > 10)
				assert_false(drawn);
		}
		assert_true(is_red(pixel_of(&studio, (rb_vec3){0, -0.3, 0.6})));
		studio_close(&studio);
	}
}

static void what_near_far_and_frustum_cut_off_is_not_drawn(void **state)
{
	(void)state;
	for (int way = 0; way < 4; way++) {
		struct studio studio;
		open_straight(&studio, 6);
		studio.camera.wireframe = way % 2 == 1;
		studio_ball(&studio, 0.5, (rb_vec3){-2, -6, 0}, red);  /* at 4 m */
		studio_ball(&studio, 0.5, (rb_vec3){0, 0, 0}, green);  /* at 10 m */
		studio_ball(&studio, 0.5, (rb_vec3){2, 6, 0}, blue);   /* at 16 m */
		studio_ball(&studio, 0.5, (rb_vec3){2, -20, 0}, blue); /* behind */
		studio.camera.near = 7;
		studio.camera.far = 13;
		if (way >= 2) {
			/* the picture's middle is 1 m beside the line of sight */
			const double edges[6] = {-3, 5, -3, 3, 7, 13};
			studio.camera.has_frustum = true;
			memcpy(studio.camera.frustum, edges, sizeof edges);
		}
		studio_seal(&studio);
		studio_draw(&studio);
		const int middle = way >= 2 ? WIDTH / 2 - 20 : WIDTH / 2;
		int inside = 0;
		for (int y = 0; y < HEIGHT; y++)
			for (int x = 0; x < WIDTH; x++) {
				const bool near_it = hypot(x + 0.5 - middle, y - HEIGHT / 2.0) < 12;
				const bool drawn = !is_paper(pixel_at(&studio, x, y));
				assert_true(near_it || !drawn);
				inside += drawn;
			}
		assert_true(inside > 30);
		studio_close(&studio);
	}
}

static void depth_and_projection_agree_with_pixels(void **state)
{
	struct studio studio;
	struct rb_view view;
	const rb_vec3 world = {0.7, 3, -0.4};
	double pixel[2], a, b;
	float m[16];

	(void)state;
	open_straight(&studio, 4);
	studio_ball(&studio, 0.5, (rb_vec3){0, 0, 0}, red);
	studio_seal(&studio);
	studio.camera.near = 8;
	studio.camera.far = 20;
	assert_int_equal(
		rb_view_make(&view, studio.lab.model, &studio.camera, &studio.frame, NULL, NULL),
		RB_OK);
	const rb_vec3 p = rb_view_point(&view, world);
	rb_view_pixel(&view, p, pixel);
	assert_near(pixel[0], WIDTH / 2.0 + 0.7 * 30, 1e-9);
	assert_near(pixel[1], HEIGHT / 2.0 + 0.4 * 30, 1e-9);
	rb_view_depth(&view, &a, &b);
	/* at 13 m of 8 to 20 */
	assert_near(a + b * -p.z, 7.0 / 12, 1e-12);
	for (int zero = 0; zero < 2; zero++) {
		double clip[4];
		rb_view_projection(&view, zero, m);
		for (int r = 0; r < 4; r++)
			clip[r] = (double)m[r] * p.x + (double)m[4 + r] * p.y +
			          (double)m[8 + r] * p.z + (double)m[12 + r];
		assert_near(clip[3], 1, 0);
		assert_near((clip[0] + 1) / 2 * WIDTH, pixel[0], 1e-4);
		assert_near((clip[1] + 1) / 2 * HEIGHT, pixel[1], 1e-4);
		assert_near(zero ? clip[2] : (clip[2] + 1) / 2, 7.0 / 12, 1e-6);
	}
	studio_close(&studio);
}

/* What is all in the picture is what the height without 'position' is for. */
static void a_camera_without_a_place_and_height_frames_all(void **state)
{
	(void)state;
	for (int given = 0; given < 2; given++) {
		struct studio studio;
		struct rb_framing framing;
		struct rb_view view;
		char text[80];
		open_straight(&studio, given ? 100 : (double)NAN);
		studio.camera.framed = true;
		for (int k = 0; k < 5; k++)
			studio_ball(&studio, 0.3 * k + 0.1,
			            (rb_vec3){4.0 * k, 5.0 * (k % 2), 3.0 * (k % 3)}, red);
		studio_seal(&studio);
		assert_int_equal(rb_framing_init(&framing, studio.lab.model, NULL), RB_OK);
		assert_int_equal(rb_framing_aim(&framing, &studio.camera, text, sizeof text), 0);
		rb_framing_release(&framing);
		if (given)
			assert_near(studio.camera.height, 100, 0);
		else
			assert_true(studio.camera.height > 5 && studio.camera.height < 40);
		assert_int_equal(rb_view_make(&view, studio.lab.model, &studio.camera,
		                              &studio.frame, NULL, NULL),
		                 RB_OK);
		for (int k = 0; k < 5; k++) {
			const double r = (0.3 * k + 0.1) / rb_view_pixel_size(&view);
			double at[2];
			rb_view_pixel(&view, rb_view_point(&view, studio.lab.model->position[k]),
			              at);
			assert_true(at[0] > r && at[0] < WIDTH - r);
			assert_true(at[1] > r && at[1] < HEIGHT - r);
		}
		studio_close(&studio);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ball_is_a_disc_of_its_radius_at_any_depth),
		cmocka_unit_test(what_is_nearer_hides_what_is_farther),
		cmocka_unit_test(parallel_edges_stay_parallel),
		cmocka_unit_test(a_floor_fills_the_picture_unless_it_is_seen_edge_on),
		cmocka_unit_test(what_near_far_and_frustum_cut_off_is_not_drawn),
		cmocka_unit_test(depth_and_projection_agree_with_pixels),
		cmocka_unit_test(a_camera_without_a_place_and_height_frames_all),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
