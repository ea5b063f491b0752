/* SPDX-License-Identifier: MIT */
/* src/film/painter.c and its rooms: what stands where in a picture, and that it is the same picture every time. */
#include "film/painter.h"

#include "film/png.h"
#include "studio.h"

static void bodies_are_where_they_should_be_and_nothing_is_flipped(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	studio_ball(&studio, 0.5, (rb_vec3){-2, 0, 1}, red);
	studio_ball(&studio, 0.5, (rb_vec3){2, 0, 1}, green);
	studio_ball(&studio, 0.5, (rb_vec3){0, 0, 2.6}, blue);
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_red(pixel_of(&studio, (rb_vec3){-2, 0, 1})));
	assert_true(is_green(pixel_of(&studio, (rb_vec3){2, 0, 1})));
	assert_true(is_blue(pixel_of(&studio, (rb_vec3){0, 0, 2.6})));
	assert_true(is_sky(pixel_of(&studio, (rb_vec3){0, 0, 1})));
	/* Without the help of our own projection: left, right, above. */
	assert_true(is_red(pixel_at(&studio, WIDTH / 2 - 36, HEIGHT / 2)));
	assert_true(is_green(pixel_at(&studio, WIDTH / 2 + 36, HEIGHT / 2)));
	assert_true(is_blue(pixel_at(&studio, WIDTH / 2, HEIGHT / 2 - 29)));
	for (int k = 0; k < WIDTH * HEIGHT; k++)
		assert_int_equal(studio.picture.rgba[4 * k + 3], 255);
	studio_close(&studio);
}

/* A camera that was placed for a body shows where a small one is; others show it as it is. */
static void a_body_too_small_to_be_seen_is_a_dot_where_nobody_placed_the_camera(void **state)
{
	int dots[4] = {0, 0, 0, 0};

	(void)state;
	/* not framed; framed; by parallel lines of sight; framed among more bodies than dots are for */
	for (int k = 0; k < 4; k++) {
		struct studio studio;

		studio_open(&studio);
		studio.camera.framed = k > 0;
		studio.camera.orthographic = k == 2;
		studio.camera.height = 150;
		studio.camera.position.value = (rb_vec3){0, -300, 100};
		for (int i = 0; k == 3 && i < RB_CAMERA_TRAILS_MAX; i++)
			studio_ball(&studio, 0.05, (rb_vec3){i, 500, 500}, blue);
		studio_ball(&studio, 0.05, (rb_vec3){0, 0, 0.05}, red);
		struct rb_body_def hidden = lab_sphere_def(0.05, 1, (rb_vec3){20, 0, 0.05},
		                                           (rb_vec3){0, 0, 0});
		rb_vec3_to(hidden.color, red);
		hidden.visible = false;
		lab_add(&studio.lab, &hidden);
		lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		studio_seal(&studio);
		studio_draw(&studio);
		for (int p = 0; p < WIDTH * HEIGHT; p++)
			dots[k] += is_red(&studio.picture.rgba[4 * p]);
		studio_close(&studio);
	}
	assert_true(dots[0] <= 2 && dots[3] <= 2);
	/* 3 pixels wide, its edge softened; the ground hides none of it */
	assert_in_range(dots[1], 8, 16);
	assert_in_range(dots[2], 8, 16);
}

static void the_silhouette_of_a_sphere_is_that_of_its_cone(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	/* Off the axis, where the outline is an ellipse: no disc would do. */
	studio_ball(&studio, 1, (rb_vec3){2.2, -3, 1.4}, red);
	const double paper[3] = {1, 1, 1};
	memcpy(studio.camera.background, paper, sizeof paper);
	studio_seal(&studio);
	studio_draw(&studio);
	struct rb_view view;
	assert_int_equal(
		rb_view_make(&view, studio.lab.model, &studio.camera, &studio.frame, NULL, NULL),
		RB_OK);
	const rb_vec3 c = rb_view_point(&view, (rb_vec3){2.2, -3, 1.4});
	int inside = 0, outside = 0;
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const rb_vec3 way = rb_vec3_unit(
				(rb_vec3){view.left_slope +
			                          (x + 0.5) / WIDTH *
			                                  (view.right_slope - view.left_slope),
			                  view.top_slope +
			                          (y + 0.5) / HEIGHT *
			                                  (view.bottom_slope - view.top_slope),
			                  -1},
				c);
			const double off = rb_vec3_length(
				rb_vec3_add_scaled(c, -rb_vec3_dot(c, way), way));
			const uint8_t *p = pixel_at(&studio, x, y);
			/* A pixel here is about 0.045 m. */
			if (off < 0.95) {
				assert_true(p[1] < 200); /* red, or its highlight */
				inside++;
			} else if (off > 1.05) {
				assert_int_equal(brightness(p), 3 * 255);
				outside++;
			}
		}
	assert_true(inside > 1000 && outside > 10000);
	studio_close(&studio);
}

static void what_is_nearer_hides_what_is_behind(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	studio_ball(&studio, 0.5, (rb_vec3){-0.5, -2, 0.5}, red);
	studio_ball(&studio, 0.5, (rb_vec3){0.8, 2, 0.75}, green);
	studio_ball(&studio, 0.5, (rb_vec3){-0.5, 0, 0.4}, blue);
	lab_rectangle(&studio.lab, (rb_vec3){0, 1, 0}, (rb_vec3){0, -1, 0}, 3, 2);
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_red(pixel_of(&studio, (rb_vec3){-0.5, -2, 0.5})));
	assert_true(is_blue(pixel_of(&studio, (rb_vec3){-0.5, 0, 0.8})));
	/* From its middle upwards the green ball sticks out over the wall. */
	assert_true(is_green(pixel_of(&studio, (rb_vec3){0.8, 2, 1.15})));
	assert_false(is_green(pixel_of(&studio, (rb_vec3){0.8, 2, 0.5})));
	studio_close(&studio);
}

static void a_shadow_is_darker_and_lies_away_from_the_light(void **state)
{
	struct studio studio;
	int lit[2], dark[2];

	(void)state;
	for (int shadows = 0; shadows < 2; shadows++) {
		studio_open(&studio);
		studio.camera.shadows = shadows;
		studio.camera.light_count = 1;
		studio.camera.lights[0] = (struct rb_light_def){.position = {-1, 0, 1},
		                                                .kind = RB_LIGHT_SUN,
		                                                .color = {1, 1, 1},
		                                                .intensity = 0.5};
		studio_ball(&studio, 0.5, (rb_vec3){0, 0, 1.5}, red);
		lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		studio_seal(&studio);
		studio_draw(&studio);
		dark[shadows] = brightness(pixel_of(&studio, (rb_vec3){1.5, 0, 0}));
		lit[shadows] = brightness(pixel_of(&studio, (rb_vec3){-1.5, 0, 0}));
		studio_close(&studio);
	}
	assert_near(dark[0], lit[0], 3);
	assert_near(lit[1], lit[0], 3);
	assert_true(dark[1] < lit[1] - 60);
}

static void a_lamp_throws_a_shadow_too_and_unseen_bodies_none(void **state)
{
	struct studio studio;
	int under[2];

	(void)state;
	for (int visible = 0; visible < 2; visible++) {
		studio_open(&studio);
		studio.camera.light_count = 1;
		studio.camera.lights[0] = (struct rb_light_def){
			.position = {0, 0, 4}, .color = {1, 1, 1}, .intensity = 0.6};
		const int id = studio_ball(&studio, 0.3, (rb_vec3){0, 0, 2.5}, red);
		studio.lab.scene.bodies[id].visible = visible;
		lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		studio_seal(&studio);
		studio_draw(&studio);
		under[visible] = brightness(pixel_of(&studio, (rb_vec3){0, 0, 0}));
		studio_close(&studio);
	}
	assert_true(under[1] < under[0] - 60);
}

/* The body's upper front quarter, of two colours: which one shows depends on how it has turned. */
static void patterns_turn_with_their_body(void **state)
{
	static const char *const textures[] = {"checker", "stripes", "beachball"};
	struct studio studio;

	(void)state;
	for (int k = 0; k < 3; k++) {
		studio_open(&studio);
		const int id = studio_ball(&studio, 1.5, (rb_vec3){0, 0, 1}, red);
		studio.lab.scene.bodies[id].texture = textures[k];
		studio_seal(&studio);
		assert_non_null(studio.frame.orientation);
		int red_before = 0, changed = 0, seen = 0;
		bool was[WIDTH];
		studio_draw(&studio);
		for (int x = 0; x < WIDTH; x++) {
			was[x] = is_red(pixel_at(&studio, x, HEIGHT / 2 - 9));
			red_before += was[x];
		}
		/* About the line of sight: an eighth of a turn moves every pattern. */
		rb_quat_to(studio.frame.orientation,
		           rb_quat_from_turn((rb_vec3){0.5, acos(-1) / 4, 0.2}));
		studio_draw(&studio);
		for (int x = WIDTH / 2 - 25; x < WIDTH / 2 + 25; x++) {
			changed += was[x] != is_red(pixel_at(&studio, x, HEIGHT / 2 - 9));
			seen++;
		}
		assert_true(red_before > 0);
		assert_true(changed > seen / 5);
		studio_close(&studio);
	}
}

static void add_picture(struct studio *studio, const char *name, int width, int height,
                        uint8_t *rgba)
{
	const struct rb_pixmap image = {width, height, rgba};
	char folder[256], path[300], bytes[8192];

	snprintf(path, sizeof path, "%s/%s", support_folder(folder), name);
	assert_int_equal(rb_png_write(path, false, &image, NULL, NULL, &studio->err), RB_OK);
	FILE *const file = fopen(path, "rb");
	assert_non_null(file);
	const size_t size = fread(bytes, 1, sizeof bytes, file);
	fclose(file);
	remove(path);
	rmdir(folder);
	assert_int_equal(rb_scene_add_file(&studio->lab.scene, name, bytes, size, "", &studio->err),
	                 RB_OK);
}

/* Balls left and right, and the ground before them. */
static void each_body_has_its_own_picture(void **state)
{
	static const char *const names[] = {"red.png", "green.png", "blue.png"};
	struct studio studio;

	(void)state;
	studio_open(&studio);
	for (int k = 0; k < 3; k++) {
		uint8_t rgba[8 * 8 * 4];

		for (int i = 0; i < 8 * 8 * 4; i++)
			rgba[i] = i % 4 == 3 ? 255 : i % 4 == k ? 220 : 10;
		add_picture(&studio, names[k], 8, 8, rgba);
		struct rb_body_def def = lab_sphere_def(1, 1, (rb_vec3){k ? 1.5 : -1.5, 0, 1.5},
		                                        (rb_vec3){0, 0, 0});
		if (k == 2) {
			def = rb_body_def_default();
			def.call = "plane";
			def.shape.kind = RB_SHAPE_PLANE;
			def.orientation = rb_plane_orientation((rb_vec3){0, 0, 1},
			                                       (rb_vec3){(double)NAN, 0, 0});
			def.is_static = true;
		}
		def.texture = names[k];
		lab_add(&studio.lab, &def);
	}
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_red(pixel_at(&studio, WIDTH / 2 - 30, HEIGHT / 2 - 10)));
	assert_true(is_green(pixel_at(&studio, WIDTH / 2 + 30, HEIGHT / 2 - 10)));
	assert_true(is_blue(pixel_at(&studio, WIDTH / 2, HEIGHT - 10)));
	studio_close(&studio);
}

/* Seen from above: its upper half red, and of the lower one the left green and the right blue; from edge to edge. */
static void a_picture_lies_on_a_rectangle_as_it_hangs(void **state)
{
	struct studio studio;
	uint8_t rgba[16 * 16 * 4];

	(void)state;
	for (int y = 0; y < 16; y++)
		for (int x = 0; x < 16; x++) {
			const uint8_t upper[4] = {220, 10, 10, 255}, left[4] = {10, 220, 10, 255},
				      right[4] = {10, 10, 220, 255};
			memcpy(rgba + 4 * (y * 16 + x), y < 8 ? upper : x < 8 ? left : right, 4);
		}
	studio_open(&studio);
	studio.camera.position.value = (rb_vec3){0, -0.1, 8};
	studio.camera.look_at.value = (rb_vec3){0, 0, 0};
	add_picture(&studio, "sheet.png", 16, 16, rgba);
	const int id = lab_rectangle(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1}, 4, 4);
	studio.lab.scene.bodies[id].texture = "sheet.png";
	studio_ball(&studio, 0.1, (rb_vec3){0, 0, 0.1}, red);
	studio_seal(&studio);
	studio_draw(&studio);
	for (int k = 5; k <= 25; k += 10) {
		assert_true(is_red(pixel_at(&studio, WIDTH / 2 - k, HEIGHT / 2 - k)));
		assert_true(is_red(pixel_at(&studio, WIDTH / 2 + k, HEIGHT / 2 - k)));
		assert_true(is_green(pixel_at(&studio, WIDTH / 2 - k, HEIGHT / 2 + k)));
		assert_true(is_blue(pixel_at(&studio, WIDTH / 2 + k, HEIGHT / 2 + k)));
	}
	studio_close(&studio);
}

/* Northern half red, southern half blue, west of the meridian green below. */
static void a_picture_lies_on_a_sphere_as_on_a_globe(void **state)
{
	struct studio studio;
	uint8_t rgba[32 * 16 * 4];

	(void)state;
	for (int y = 0; y < 16; y++)
		for (int x = 0; x < 32; x++) {
			const uint8_t north[4] = {220, 10, 10, 255}, east[4] = {10, 10, 220, 255},
				      west[4] = {10, 200, 10, 255};
			/* longitude -90 degrees, which the camera looks at, is a quarter from the left */
			memcpy(rgba + 4 * (y * 32 + x), y < 8 ? north : x < 8 ? west : east, 4);
		}
	studio_open(&studio);
	add_picture(&studio, "globe.png", 32, 16, rgba);
	struct rb_body_def def = lab_sphere_def(1.5, 1, (rb_vec3){0, 0, 1}, (rb_vec3){0, 0, 0});
	def.texture = "globe.png";
	lab_add(&studio.lab, &def);
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_red(pixel_at(&studio, WIDTH / 2 - 15, HEIGHT / 2 - 15)));
	assert_true(is_red(pixel_at(&studio, WIDTH / 2 + 15, HEIGHT / 2 - 15)));
	assert_true(is_green(pixel_at(&studio, WIDTH / 2 - 15, HEIGHT / 2 + 15)));
	assert_true(is_blue(pixel_at(&studio, WIDTH / 2 + 15, HEIGHT / 2 + 15)));
	studio_close(&studio);
}

static void a_texture_that_is_no_picture_is_told_with_its_place(void **state)
{
	struct studio studio;
	struct rb_painter *painter = NULL;

	(void)state;
	studio_open(&studio);
	struct rb_body_def def = lab_sphere_def(1, 1, (rb_vec3){0, 0, 1}, (rb_vec3){0, 0, 0});
	def.texture = "notes.png";
	def.name = "ball";
	def.line = 12;
	lab_add(&studio.lab, &def);
	assert_int_equal(rb_scene_add_file(&studio.lab.scene, "notes.png", "not a picture", 13, "",
	                                   &studio.err),
	                 RB_OK);
	struct lab *lab = &studio.lab;
	assert_int_equal(rb_model_create(&lab->model, &lab->scene, NULL, &lab->error), RB_OK);
	assert_int_equal(rb_painter_create(&painter, lab->model, &studio.camera, &studio.err),
	                 RB_ERR_SCENE);
	assert_null(painter);
	assert_non_null(strstr(studio.err.text, "12"));
	assert_non_null(strstr(studio.err.text, "'ball'"));
	assert_non_null(strstr(studio.err.text, "notes.png"));
	studio_close(&studio);
}

/* One that is drawn in two bands. */
static void a_large_picture_is_drawn_from_edge_to_edge_and_can_be_given_up(void **state)
{
	enum { SIDE = 4160 };
	const double colour[3] = {0.2, 0.5, 0.7};
	struct rb_pixmap picture;
	struct studio studio;
	atomic_bool cut;

	(void)state;
	studio_open(&studio);
	studio.camera.size_px[0] = studio.camera.size_px[1] = SIDE;
	memcpy(studio.camera.background, colour, sizeof colour);
	studio_ball(&studio, 3.6, (rb_vec3){0, 0, 1}, red);
	studio_seal(&studio);
	atomic_init(&cut, false);
	rb_painter_heed(studio.painter, &cut);
	studio_draw(&studio);
	for (int k = 0; k < 3; k++) {
		assert_in_range(pixel_at(&studio, 5, 0)[k], (int)(colour[k] * 255) - 1,
		                (int)(colour[k] * 255) + 1);
		assert_int_equal(pixel_at(&studio, 5, SIDE - 1)[k], pixel_at(&studio, 5, 0)[k]);
	}
	/* over the seam of the bands, too */
	for (int y = 30; y < SIDE - 30; y++)
		assert_true(is_red(pixel_at(&studio, SIDE / 2, y)) ||
		            memcmp(pixel_at(&studio, SIDE / 2, y), pixel_at(&studio, 5, 0), 3) ==
		                    0);
	assert_true(is_red(pixel_at(&studio, SIDE / 2, SIDE / 2)));
	atomic_store(&cut, true);
	assert_int_equal(
		rb_painter_draw(studio.painter, &studio.frame, NULL, NULL, &picture, &studio.err),
		RB_ERR_INTERRUPT);
	atomic_store(&cut, false);
	studio_draw(&studio);
	studio_close(&studio);
}

static void a_plain_background_is_the_colour_that_was_asked_for(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	const double colour[3] = {0.2, 0.5, 0.7};
	memcpy(studio.camera.background, colour, sizeof colour);
	studio_ball(&studio, 0.5, (rb_vec3){0, 0, 1}, red);
	studio_seal(&studio);
	studio_draw(&studio);
	const uint8_t *p = pixel_at(&studio, 3, 3);
	for (int k = 0; k < 3; k++)
		assert_near(p[k], 255 * colour[k], 1);
	studio_close(&studio);
}

static void edges_are_smooth_only_with_samples(void **state)
{
	struct studio studio;
	int between[2];

	(void)state;
	for (int k = 0; k < 2; k++) {
		const double black[3] = {0, 0, 0};
		studio_open(&studio);
		memcpy(studio.camera.background, black, sizeof black);
		studio.camera.samples = k ? 4 : 1;
		/* Light without direction would be best; the ambient one is nearly that. */
		studio.camera.light_count = 0;
		studio_ball(&studio, 1.5, (rb_vec3){0, 0, 1}, (rb_vec3){1, 1, 1});
		studio_seal(&studio);
		studio_draw(&studio);
		between[k] = 0;
		for (int i = 0; i < WIDTH * HEIGHT; i++) {
			const int b = brightness(studio.picture.rgba + 4 * i);
			between[k] += b > 15 && b < 200;
		}
		studio_close(&studio);
	}
	assert_int_equal(between[0], 0);
	assert_true(between[1] > 50);
}

static void lines_of_all_kinds_are_seen(void **state)
{
	(void)state;
	for (int kind = 0; kind < 3; kind++) {
		struct studio studio;
		studio_open(&studio);
		const int id = studio_ball(&studio, 0.5, (rb_vec3){0, 0, 1}, blue);
		studio.lab.scene.bodies[id].velocity = (rb_vec3){0, 0, 6};
		studio.camera.vectors = kind == 0   ? RB_VECTORS_VELOCITY
		                        : kind == 1 ? RB_VECTORS_CONTACT
		                                    : 0;
		studio.camera.wireframe = kind == 2;
		lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		studio_seal(&studio);
		studio.frame.contacts[0] = (struct rb_frame_contact){
			.a = 0, .b = 1, .point = {1, 0, 0}, .force = {0, 0, 20}};
		studio.frame.contact_count = 1;
		studio_draw(&studio);
		int found = 0;
		for (int i = 0; i < WIDTH * HEIGHT; i++) {
			const uint8_t *p = studio.picture.rgba + 4 * i;
			found += kind == 0   ? p[0] > 200 && p[1] > 140 && p[2] < 120
			         : kind == 1 ? is_red(p)
			                     : is_blue(p);
		}
		assert_true(found > 20);
		/* A wire model has nothing in its middle. */
		if (kind == 2)
			assert_false(is_blue(pixel_of(&studio, (rb_vec3){0.12, 0, 1.12})));
		studio_close(&studio);
	}
}

static void a_trail_shows_where_a_body_was(void **state)
{
	struct studio studio;
	struct rb_trails trails = {.path_count = 1, .point_count = 20};
	static double points[1][RB_TRAIL_POINTS_MAX][3], times[RB_TRAIL_POINTS_MAX];

	(void)state;
	studio_open(&studio);
	studio.camera.trail_count = 1;
	studio_ball(&studio, 0.3, (rb_vec3){2, 0, 1}, red);
	studio_seal(&studio);
	studio.frame.time_s = 1;
	trails.points = points;
	trails.time_s = times;
	for (int k = 0; k < 20; k++) {
		rb_vec3_to(points[0][k], (rb_vec3){0.1 * k, 0, 1});
		times[k] = 0.05 * k;
	}
	assert_int_equal(rb_painter_draw(studio.painter, &studio.frame, NULL, &trails,
	                                 &studio.picture, &studio.err),
	                 RB_OK);
	const uint8_t *on = pixel_of(&studio, (rb_vec3){1.6, 0, 1});
	assert_true(on[0] > on[2] + 30);
	assert_true(is_sky(pixel_of(&studio, (rb_vec3){1.6, 0, 1.2})));
	/* It fades to the past. */
	const uint8_t *before = pixel_of(&studio, (rb_vec3){0.2, 0, 1});
	assert_true(before[0] < before[2] + 30);
	studio_close(&studio);
}

/* Some of everything, for comparing bytes. */
static void open_mixture(struct studio *studio)
{
	static const char *const textures[] = {"checker", "stripes", "beachball", NULL};

	studio_open(studio);
	for (int k = 0; k < 24; k++) {
		struct rb_body_def def = lab_sphere_def(
			0.3, 1, (rb_vec3){k % 6 - 2.5, k / 6 - 1.5, 0.5 + 0.1 * k},
			(rb_vec3){0, 0, 1});
		def.texture = textures[k % 4];
		def.orientation = rb_quat_from_turn((rb_vec3){k, 2 * k, 3});
		lab_add(&studio->lab, &def);
	}
	const int floor = lab_plane(&studio->lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	studio->lab.scene.bodies[floor].texture = "checker";
	lab_rectangle(&studio->lab, (rb_vec3){0, 4, 1}, (rb_vec3){0, -1, 0}, 6, 2);
	studio->camera.vectors = RB_VECTORS_VELOCITY;
	studio_seal(studio);
}

static void the_same_frame_gives_the_same_bytes_whatever_was_drawn_before(void **state)
{
	struct studio studio, other;

	(void)state;
	open_mixture(&studio);
	const uint64_t first = studio_hash(&studio);
	for (int i = 0; i < studio.lab.model->body_count; i++)
		studio.frame.position[3 * i] += 3 + 0.4 * i;
	const uint64_t moved = studio_hash(&studio);
	assert_true(moved != first);
	open_mixture(&other);
	assert_true(studio_hash(&other) == first);
	for (int i = 0; i < studio.lab.model->body_count; i++)
		rb_vec3_to(studio.frame.position + 3 * i, studio.lab.model->position[i]);
	assert_true(studio_hash(&studio) == first);
	studio_close(&other);
	assert_true(studio_hash(&studio) == first);
	studio_close(&studio);
}

/* This program once more with so many threads of the rasteriser: it prints the hash of a picture. */
static uint64_t hash_with_threads(const char *threads)
{
	char self[400] = "", command[500], line[64] = "";

	assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
	snprintf(command, sizeof command, "LP_NUM_THREADS=%s RBSIM_TEST_PICTURE=1 '%s'", threads,
	         self);
	FILE *child = popen(command, "r");
	assert_non_null(child);
	assert_non_null(fgets(line, sizeof line, child));
	assert_int_equal(pclose(child), 0);
	return strtoull(line, NULL, 16);
}

static void the_number_of_threads_is_not_in_the_picture(void **state)
{
	(void)state;
	const uint64_t none = hash_with_threads("0");
	assert_true(none != 0);
	assert_true(hash_with_threads("1") == none);
	assert_true(hash_with_threads("2") == none);
	assert_true(hash_with_threads("3") == none);
}

/* A wall between the eye and its room is looked through; from its room it is seen. */
static void an_infinite_plane_is_not_drawn_from_behind(void **state)
{
	uint8_t colour[2][3];

	(void)state;
	for (int inside = 0; inside < 2; inside++) {
		struct studio studio;
		studio_open(&studio);
		studio_ball(&studio, 0.5, (rb_vec3){0, 3, 1}, red);
		lab_plane(&studio.lab, (rb_vec3){0, -1, 0}, (rb_vec3){0, 1, 0});
		studio.camera.position.value = (rb_vec3){0, inside ? 9 : -6, 1};
		studio.camera.look_at.value = (rb_vec3){0, 0, 1};
		studio_seal(&studio);
		studio_draw(&studio);
		assert_true(is_red(pixel_at(&studio, WIDTH / 2, HEIGHT / 2)));
		memcpy(colour[inside], pixel_at(&studio, 2, HEIGHT - 3), 3);
		studio_close(&studio);
	}
	/* the lower corner: sky below the horizon through the wall, the wall's grey from its room */
	assert_true(abs(colour[0][0] - colour[1][0]) + abs(colour[0][2] - colour[1][2]) > 20);
}

/* From outside a room is a box: its floor ends at the wall that one looks through. */
static void a_room_seen_from_outside_ends_at_its_walls(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	studio_ball(&studio, 0.2, (rb_vec3){0, 0, 1}, blue);
	const int floor_id = lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	rb_vec3_to(studio.lab.scene.bodies[floor_id].color, red);
	for (int k = 0; k < 4; k++) {
		const rb_vec3 out = {k == 0 ? 1 : k == 1 ? -1 : 0, k == 2 ? 1 : k == 3 ? -1 : 0, 0};
		lab_plane(&studio.lab, rb_vec3_scale(2, out), rb_vec3_neg(out));
	}
	studio.camera.position.value = (rb_vec3){0.3, -8, 3};
	studio.camera.look_at.value = (rb_vec3){0, -1, 0};
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_red(pixel_of(&studio, (rb_vec3){0.5, -1.7, 0})));
	assert_true(is_red(pixel_of(&studio, (rb_vec3){-1.5, 1, 0})));
	assert_false(is_red(pixel_of(&studio, (rb_vec3){0.5, -2.4, 0})));
	assert_false(is_red(pixel_of(&studio, (rb_vec3){2.6, -1.8, 0})));
	assert_false(is_red(pixel_of(&studio, (rb_vec3){-0.5, -3, 0})));
	studio_close(&studio);
}

/* Where bodies overlap, which is in front changes within them. */
static void bodies_that_cut_each_other_are_seen_on_both_sides_of_the_cut(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	studio_ball(&studio, 0.5, (rb_vec3){-1, 0, 1}, red);
	studio_ball(&studio, 0.5, (rb_vec3){1, 0, 1}, green);
	studio_ball(&studio, 0.5, (rb_vec3){3, 0, 1}, blue);
	lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	studio_seal(&studio);
	rb_vec3_to(studio.frame.position, (rb_vec3){-0.2, 0, 1});
	rb_vec3_to(studio.frame.position + 3, (rb_vec3){0.2, -0.05, 1});
	rb_vec3_to(studio.frame.position + 6, (rb_vec3){2, 0, 0});
	studio_draw(&studio);
	assert_true(is_red(pixel_of(&studio, (rb_vec3){-0.13, -0.49, 1})));
	assert_true(is_green(pixel_of(&studio, (rb_vec3){0.13, -0.54, 1})));
	assert_true(is_blue(pixel_of(&studio, (rb_vec3){2, -0.3, 0})));
	assert_false(is_blue(pixel_of(&studio, (rb_vec3){2, -0.7, 0})));
	studio_close(&studio);
}

static void arrows_are_as_long_in_slow_motion(void **state)
{
	uint64_t hash[2];

	(void)state;
	for (int k = 0; k < 2; k++) {
		struct studio studio;
		studio_open(&studio);
		const int id = studio_ball(&studio, 0.5, (rb_vec3){0, 0, 1}, blue);
		studio.lab.scene.bodies[id].velocity = (rb_vec3){3, 0, 3};
		studio.camera.vectors = RB_VECTORS_VELOCITY;
		studio.camera.speed = k == 0 ? 1 : 0.01;
		studio_seal(&studio);
		hash[k] = studio_hash(&studio);
		studio_close(&studio);
	}
	assert_true(hash[0] == hash[1]);
}

/* One force is as long beside a large one as alone, also where nothing weighs. */
static void an_arrow_of_a_force_does_not_depend_on_other_forces(void **state)
{
	struct studio studio;
	int found[2] = {0};

	(void)state;
	studio_open(&studio);
	studio.lab.scene.world.gravity = (rb_vec3){0, 0, 0};
	const int id = studio_ball(&studio, 0.5, (rb_vec3){0, 0, 1}, blue);
	studio.lab.scene.bodies[id].velocity = (rb_vec3){1, 0, 0};
	studio.camera.vectors = RB_VECTORS_CONTACT;
	lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	studio_seal(&studio);
	const double unit = studio.lab.model->mass[0];
	for (int k = 0; k < 2; k++) {
		studio.frame.contacts[0] = (struct rb_frame_contact){
			.a = 0, .b = 1, .point = {1, 0, 0}, .force = {0, 0, unit}};
		studio.frame.contacts[1] = (struct rb_frame_contact){
			.a = 0, .b = 1, .point = {-1, 0, 0}, .force = {0, 0, 3 * unit}};
		studio.frame.contact_count = 1 + k;
		studio_draw(&studio);
		for (int y = 0; y < HEIGHT; y++)
			for (int x = WIDTH / 2; x < WIDTH; x++)
				found[k] += is_red(pixel_at(&studio, x, y));
	}
	assert_true(found[0] > 10);
	assert_int_equal(found[0], found[1]);
	studio_close(&studio);
}

static void a_camera_inside_a_body_is_refused_and_the_painter_goes_on(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	studio_ball(&studio, 0.5, (rb_vec3){0, 0, 1}, red);
	studio_seal(&studio);
	rb_vec3_to(studio.frame.position, studio.camera.position.value);
	assert_int_equal(rb_painter_draw(studio.painter, &studio.frame, NULL, NULL, &studio.picture,
	                                 &studio.err),
	                 RB_ERR_SCENE);
	assert_null(studio.picture.rgba);
	rb_vec3_to(studio.frame.position, (rb_vec3){0, 0, 1});
	studio_draw(&studio);
	assert_true(is_red(pixel_at(&studio, WIDTH / 2, HEIGHT / 2)));
	studio_close(&studio);
}

/* Seen from as many of their own radii away, worlds of any size look the same, also far from the origin. */
static void size_and_place_of_the_world_do_not_matter(void **state)
{
	int red_count[4] = {0};

	(void)state;
	for (int k = 0; k < 4; k++) {
		const double s = k == 0 ? 1 : k == 1 ? 1e-4 : k == 2 ? 1e4 : 1;
		const rb_vec3 at = k == 3 ? (rb_vec3){1048576, 2097152, -1048576}
		                          : (rb_vec3){0, 0, 0};
		struct studio studio;
		studio_open(&studio);
		studio_ball(&studio, s, rb_vec3_add(at, (rb_vec3){0, 0, s}), red);
		lab_plane(&studio.lab, at, (rb_vec3){0, 0, 1});
		studio.camera.position.value = rb_vec3_add(at, (rb_vec3){0, -8 * s, 2 * s});
		studio.camera.look_at.value = rb_vec3_add(at, (rb_vec3){0, 0, s});
		studio_seal(&studio);
		studio_draw(&studio);
		for (int i = 0; i < WIDTH * HEIGHT; i++)
			red_count[k] += is_red(studio.picture.rgba + 4 * i);
		studio_close(&studio);
	}
	assert_true(red_count[0] > 500);
	for (int k = 1; k < 4; k++)
		assert_near(red_count[k], red_count[0], 4);
}

static int print_hash(void)
{
	struct studio studio;

	open_mixture(&studio);
	printf("%016llx\n", (unsigned long long)studio_hash(&studio));
	studio_close(&studio);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bodies_are_where_they_should_be_and_nothing_is_flipped),
		cmocka_unit_test(
			a_body_too_small_to_be_seen_is_a_dot_where_nobody_placed_the_camera),
		cmocka_unit_test(the_silhouette_of_a_sphere_is_that_of_its_cone),
		cmocka_unit_test(what_is_nearer_hides_what_is_behind),
		cmocka_unit_test(a_shadow_is_darker_and_lies_away_from_the_light),
		cmocka_unit_test(a_lamp_throws_a_shadow_too_and_unseen_bodies_none),
		cmocka_unit_test(patterns_turn_with_their_body),
		cmocka_unit_test(each_body_has_its_own_picture),
		cmocka_unit_test(a_picture_lies_on_a_rectangle_as_it_hangs),
		cmocka_unit_test(a_picture_lies_on_a_sphere_as_on_a_globe),
		cmocka_unit_test(a_texture_that_is_no_picture_is_told_with_its_place),
		cmocka_unit_test(a_large_picture_is_drawn_from_edge_to_edge_and_can_be_given_up),
		cmocka_unit_test(a_plain_background_is_the_colour_that_was_asked_for),
		cmocka_unit_test(edges_are_smooth_only_with_samples),
		cmocka_unit_test(lines_of_all_kinds_are_seen),
		cmocka_unit_test(a_trail_shows_where_a_body_was),
		cmocka_unit_test(the_same_frame_gives_the_same_bytes_whatever_was_drawn_before),
		cmocka_unit_test(the_number_of_threads_is_not_in_the_picture),
		cmocka_unit_test(an_infinite_plane_is_not_drawn_from_behind),
		cmocka_unit_test(a_room_seen_from_outside_ends_at_its_walls),
		cmocka_unit_test(bodies_that_cut_each_other_are_seen_on_both_sides_of_the_cut),
		cmocka_unit_test(arrows_are_as_long_in_slow_motion),
		cmocka_unit_test(an_arrow_of_a_force_does_not_depend_on_other_forces),
		cmocka_unit_test(a_camera_inside_a_body_is_refused_and_the_painter_goes_on),
		cmocka_unit_test(size_and_place_of_the_world_do_not_matter),
	};

	return getenv("RBSIM_TEST_PICTURE") ? print_hash()
	                                    : cmocka_run_group_tests(tests, NULL, NULL);
}
