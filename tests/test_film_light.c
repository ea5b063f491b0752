/* SPDX-License-Identifier: MIT */
/* src/film/light.c: which lights there are, and that maps of shadows hold what throws them. */
#include "film/light.h"

#include "math/vec3.h"
#include "solids.h"
#include "worlds.h"

/* Two that move and two that stand still, one of them without an end. */
static void open_scene(struct lab *lab)
{
	lab_open(lab, 1, 10);
	lab_sphere(lab, 0.1, 1, (rb_vec3){1, 2, 3}, (rb_vec3){0, 0, 0});
	lab_sphere(lab, 0.1, 1, (rb_vec3){5, -2, 1}, (rb_vec3){0, 0, 0});
	lab_rectangle(lab, (rb_vec3){0, 3, -1}, (rb_vec3){0, 0, 1}, 1, 1);
	lab_plane(lab, (rb_vec3){0, 0, -100}, (rb_vec3){0, 0, 1});
	lab->scene.world.gravity = (rb_vec3){0, -3, -4};
	assert_int_equal(rb_model_create(&lab->model, &lab->scene, NULL, &lab->error), RB_OK);
}

static void a_camera_has_the_lights_it_was_given(void **state)
{
	struct rb_camera_def camera = rb_camera_def_default();
	struct lab lab;
	struct rb_lights lights, own;

	(void)state;
	open_scene(&lab);
	rb_lights_make(&own, lab.model, &camera);
	assert_int_equal(own.count, 2);
	assert_true(own.of[0].shadow && !own.of[1].shadow);
	assert_vector(own.up, ((rb_vec3){0, 0.6, 0.8}), 1e-15);
	for (int k = 0; k < 2; k++) {
		assert_false(own.of[k].lamp);
		assert_near(rb_vec3_length(own.of[k].place), 1, 1e-15);
		assert_true(rb_vec3_dot(own.of[k].place, own.up) > 0.2);
	}
	assert_true(own.of[0].colour[1] > 4 * own.of[1].colour[1]);

	camera.light_count = 2;
	camera.lights[0] = (struct rb_light_def){
		.position = {2, 1, 13}, .color = {1, 0.5, 0}, .intensity = 2};
	camera.lights[1] = (struct rb_light_def){
		.position = {0, 0, 5}, .kind = RB_LIGHT_SUN, .color = {1, 1, 1}, .intensity = 0.5};
	rb_lights_make(&lights, lab.model, &camera);
	assert_int_equal(lights.count, 2);
	assert_true(lights.of[0].lamp && !lights.of[1].lamp);
	assert_vector(lights.of[0].place, ((rb_vec3){2, 1, 13}), 0);
	assert_vector(lights.of[1].place, ((rb_vec3){0, 0, 1}), 1e-15);
	assert_near(lights.of[0].colour[0], 2, 1e-15);
	assert_near(lights.of[0].colour[2], 0, 0);
	assert_near(lights.of[1].colour[1], 0.5, 1e-15);
	/* as bright as it says at the mean of what is somewhere, which is at 2, 1, 1 */
	assert_near(lights.of[0].reach_m, 12, 1e-14);
	for (int c = 0; c < 3; c++)
		assert_near(lights.ambient_up[c], 0.5 * own.ambient_up[c], 1e-15);
	lab_close(&lab);
}

/* A camera at a place of its own, looking at the origin. */
static struct rb_view view_from(rb_vec3 eye)
{
	struct rb_view view = {
		.eye = eye, .near = 0.01, .far = (double)INFINITY, .width = 640, .height = 480};

	view.back = rb_vec3_unit(eye, (rb_vec3){0, 0, 1});
	view.right = rb_vec3_unit(rb_vec3_cross((rb_vec3){0, 0, 1}, view.back), (rb_vec3){1, 0, 0});
	view.up = rb_vec3_cross(view.back, view.right);
	view.left_slope = -0.5, view.right_slope = 0.5;
	view.bottom_slope = -0.375, view.top_slope = 0.375;
	return view;
}

static void apply(const float matrix[16], rb_vec3 p, double to[4])
{
	const double v[4] = {p.x, p.y, p.z, 1};

	for (int r = 0; r < 4; r++) {
		to[r] = 0;
		for (int c = 0; c < 4; c++)
			to[r] += (double)matrix[4 * c + r] * v[c];
	}
}

/* The extreme points of all balls lie in the map, and near its border; looked up, in its corner of the texture. */
static void assert_fits(const struct rb_shadow_fit *fit, float (*balls)[4], int count, double least)
{
	double most = 0;

	assert_in_range(fit->side, 1, RB_SHADOW_SIDE);
	for (int k = 0; k < count; k++)
		for (int way = 0; way < 6; way++) {
			rb_vec3 p = {(double)balls[k][0], (double)balls[k][1], (double)balls[k][2]};
			const double r = (way % 2 ? -1 : 1) * (double)balls[k][3];
			double at[4], seen[4];

			p = rb_vec3_add(p, (rb_vec3){way / 2 == 0 ? r : 0, way / 2 == 1 ? r : 0,
			                             way / 2 == 2 ? r : 0});
			apply(fit->to_map, p, at);
			apply(fit->lookup, p, seen);
			assert_true(at[3] > 0);
			for (int i = 0; i < 3; i++)
				assert_true(fabs(at[i]) <= at[3] * (1 + 1e-5));
			for (int i = 0; i < 2; i++)
				most = fmax(most, fabs(at[i]) / at[3]);
			assert_near(seen[3], at[3], 1e-5 * at[3]);
			assert_near(seen[2] / seen[3], 0.5 + 0.5 * at[2] / at[3], 1e-5);
			const double side = (double)fit->side / RB_SHADOW_SIDE;
			for (int i = 0; i < 2; i++) {
				const double texture = seen[i] / seen[3];
				assert_true(texture > 0 && texture < side + 8.0 / RB_SHADOW_SIDE);
				/* the border of the map is as wide on either side */
				assert_near(texture - side * (0.5 + 0.5 * at[i] / at[3]),
				            seen[1] / seen[3] - side * (0.5 + 0.5 * at[1] / at[3]),
				            1e-5);
			}
		}
	assert_true(most > least);
}

static void maps_hold_all_that_throws_shadows(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 40; k++) {
		const struct rb_view view = view_from((rb_vec3){solids_random(k, 0, 3, 9),
		                                                solids_random(k, 1, -9, 9),
		                                                solids_random(k, 2, 1, 7)});
		float balls[6][4];
		struct rb_light light = {.lamp = k % 2, .shadow = true};
		struct rb_shadow_fit fit;

		for (uint64_t b = 0; b < 6; b++) {
			const rb_vec3 world = {solids_random(k, 10 + 4 * b, -2, 2),
			                       solids_random(k, 11 + 4 * b, -1, 1),
			                       solids_random(k, 12 + 4 * b, 0, 1.5)};
			const rb_vec3 p = rb_view_point(&view, world);
			balls[b][0] = (float)p.x, balls[b][1] = (float)p.y,
			balls[b][2] = (float)p.z;
			balls[b][3] = (float)solids_random(k, 13 + 4 * b, 0.05, 0.4);
		}
		const rb_vec3 sky = {solids_random(k, 50, -1, 1), solids_random(k, 51, -1, 1), 1};
		light.place = light.lamp ? rb_vec3_scale(9, sky) : rb_vec3_unit(sky, sky);
		const struct rb_casters casters = {
			.balls = &balls[0][0], .ball_count = 6, .stride = 4};
		rb_shadow_fit(&fit, &light, &view, &casters, RB_SHADOW_SIDE);
		/* a lamp's cone goes round a sphere about them all, a sun's box is a little larger than they are */
		assert_fits(&fit, balls, 6, light.lamp ? 0.35 : 0.75);
		assert_near((double)fit.source[3], light.lamp ? 1 : 0, 0);
		const rb_vec3 source = {(double)fit.source[0], (double)fit.source[1],
		                        (double)fit.source[2]};
		assert_vector(source,
		              (light.lamp ? rb_view_point(&view, light.place)
		                          : rb_view_direction(&view, light.place)),
		              1e-5);
	}
}

/* A ball nearer to the light comes first in the map's depth. */
static void depth_in_a_map_grows_away_from_the_light(void **state)
{
	const struct rb_view view = view_from((rb_vec3){0, -8, 2});

	(void)state;
	for (int lamp = 0; lamp < 2; lamp++) {
		const struct rb_light light = {
			.lamp = lamp, .shadow = true, .place = {0, 0, lamp ? 6 : 1}};
		struct rb_shadow_fit fit;
		float balls[2][4];
		double at[2][4];

		for (int b = 0; b < 2; b++) {
			const rb_vec3 p = rb_view_point(&view, (rb_vec3){0, 0, b});
			balls[b][0] = (float)p.x, balls[b][1] = (float)p.y,
			balls[b][2] = (float)p.z;
			balls[b][3] = 0.25f;
		}
		const struct rb_casters casters = {
			.balls = &balls[0][0], .ball_count = 2, .stride = 4};
		rb_shadow_fit(&fit, &light, &view, &casters, RB_SHADOW_SIDE);
		for (int b = 0; b < 2; b++)
			apply(fit.lookup,
			      (rb_vec3){(double)balls[b][0], (double)balls[b][1],
			                (double)balls[b][2]},
			      at[b]);
		assert_true(at[1][2] / at[1][3] < at[0][2] / at[0][3]);
		for (int i = 0; i < 2; i++) /* one below the other: the same place */
			assert_near(at[0][i] / at[0][3], at[1][i] / at[1][3], 1e-5);
	}
}

static void without_anything_there_is_no_map(void **state)
{
	const struct rb_view view = view_from((rb_vec3){0, -8, 2});
	const struct rb_casters none = {.stride = 4};

	(void)state;
	for (int lamp = 0; lamp < 2; lamp++) {
		const struct rb_light light = {.lamp = lamp, .shadow = true, .place = {0, 0, 1}};
		struct rb_shadow_fit fit;
		float rows[4][4] = {{0}};

		rb_shadow_fit(&fit, &light, &view, &none, RB_SHADOW_SIDE);
		assert_int_equal(fit.side, 0);
		rb_shadow_tell(&fit, &light, &view, rows);
		if (lamp) /* everything is lit */
			assert_near((double)rows[3][3], 1, 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_camera_has_the_lights_it_was_given),
		cmocka_unit_test(maps_hold_all_that_throws_shadows),
		cmocka_unit_test(depth_in_a_map_grows_away_from_the_light),
		cmocka_unit_test(without_anything_there_is_no_map),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
