/* SPDX-License-Identifier: MIT */
/* What kinds of lights do in pictures: where they light, how evenly, and how they shine on bodies. */
#include "film/painter.h"

#include <math.h>

#include "studio.h"

/* A floor, lit as the camera's lights say: how much of it at a distance from the origin, in sixteen directions. */
static int lit_parts_of_floor(const struct rb_light_def *lights, int count, double radius)
{
	struct studio studio;
	int lit = 0;

	studio_open(&studio);
	studio.camera.light_count = count;
	memcpy(studio.camera.lights, lights, (size_t)count * sizeof *lights);
	studio.camera.position.value = (rb_vec3){0, -2, 7};
	studio.camera.look_at.value = (rb_vec3){0, 0, 0};
	lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	studio_seal(&studio);
	studio_draw(&studio);
	for (int k = 0; k < 16; k++) {
		const double angle = 2 * acos(-1.0) * k / 16;
		lit += brightness(pixel_of(&studio, (rb_vec3){radius * cos(angle),
		                                              radius * sin(angle), 0})) > 20;
	}
	studio_close(&studio);
	return lit;
}

static void a_spot_lights_only_its_cone(void **state)
{
	static const double angles[] = {0.25, 0.4, 0.6};
	struct rb_light_def lights[2] = {
		{.kind = RB_LIGHT_SPOT, .position = {0, 0, 2}, .color = {1, 1, 1}, .intensity = 2},
		{.kind = RB_LIGHT_AMBIENT, .color = {1, 1, 1}, .intensity = 0}};

	(void)state;
	for (int k = 0; k < 3; k++) {
		const double radius = lights[0].position.z * tan(angles[k]);
		lights[0].angle = angles[k];
		/* A pixel here is about 0.05 m of the floor. */
		assert_int_equal(lit_parts_of_floor(lights, 2, radius - 0.11), 16);
		assert_int_equal(lit_parts_of_floor(lights, 2, radius + 0.11), 0);
		/* With a soft edge the outer one stays, and light fades out before. */
		lights[0].softness = 1;
		assert_int_equal(lit_parts_of_floor(lights, 2, radius + 0.11), 0);
		assert_int_equal(lit_parts_of_floor(lights, 2, 0.3 * radius), 16);
		lights[0].softness = 0;
	}
	/* As a lamp it lights all. */
	lights[0].kind = RB_LIGHT_LAMP;
	assert_int_equal(lit_parts_of_floor(lights, 2, 1.5), 16);
}

static void a_spot_throws_a_shadow(void **state)
{
	struct studio studio;
	int under[2];

	(void)state;
	for (int visible = 0; visible < 2; visible++) {
		studio_open(&studio);
		studio.camera.light_count = 1;
		studio.camera.lights[0] = (struct rb_light_def){.kind = RB_LIGHT_SPOT,
		                                                .position = {0, 0, 4},
		                                                .angle = 0.5,
		                                                .softness = 0.2,
		                                                .color = {1, 1, 1},
		                                                .intensity = 0.6};
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

static void ambient_light_is_alike_on_all_sides(void **state)
{
	struct studio studio;
	int least = 3 * 255, most = 0, count = 0, last = 0;

	(void)state;
	for (int k = 1; k <= 2; k++) {
		studio_open(&studio);
		studio.camera.light_count = 1;
		studio.camera.lights[0] = (struct rb_light_def){
			.kind = RB_LIGHT_AMBIENT, .color = {1, 1, 1}, .intensity = 0.3 * k};
		const int id = studio_ball(&studio, 1, (rb_vec3){0, 0, 1.2}, red);
		studio.lab.scene.bodies[id].texture = "none";
		studio_seal(&studio);
		studio_draw(&studio);
		least = 3 * 255, most = 0, count = 0;
		for (int y = 0; y < HEIGHT; y++)
			for (int x = 0; x < WIDTH; x++) {
				const uint8_t *p = pixel_at(&studio, x, y);
				/* not the edge, which is mixed with the sky */
				if (!is_red(p) || !is_red(pixel_at(&studio, x - 2, y)) ||
				    !is_red(pixel_at(&studio, x + 2, y)) ||
				    !is_red(pixel_at(&studio, x, y - 2)) ||
				    !is_red(pixel_at(&studio, x, y + 2)))
					continue;
				least = brightness(p) < least ? brightness(p) : least;
				most = brightness(p) > most ? brightness(p) : most;
				count++;
			}
		assert_true(count > 500);
		assert_true(most - least <= 3);
		assert_true(most > last + 20);
		last = most;
		studio_close(&studio);
	}
}

/* A red ball under a sun: how green every pixel is, which the ball itself is not, but its highlight. */
static void draw_highlight(double shininess, int green_of[WIDTH * HEIGHT])
{
	struct studio studio;

	studio_open(&studio);
	studio.camera.light_count = 1;
	studio.camera.lights[0] = (struct rb_light_def){.kind = RB_LIGHT_SUN,
	                                                .position = {-1, -1, 1},
	                                                .color = {1, 1, 1},
	                                                .intensity = 0.2};
	const int id = studio_ball(&studio, 1.5, (rb_vec3){0, 0, 1.2}, red);
	studio.lab.scene.bodies[id].texture = "none";
	studio.lab.scene.materials[studio.lab.scene.bodies[id].material].shininess = shininess;
	studio_seal(&studio);
	studio_draw(&studio);
	for (int k = 0; k < WIDTH * HEIGHT; k++)
		green_of[k] = studio.picture.rgba[4 * k + 1];
	studio_close(&studio);
}

/* Pixels where the highlight is at least half as bright as at its brightest. */
static int highlight(double shininess)
{
	static int with[WIDTH * HEIGHT], without[WIDTH * HEIGHT];
	int most = 0, count = 0;

	draw_highlight(shininess, with);
	draw_highlight(0, without);
	for (int k = 0; k < WIDTH * HEIGHT; k++)
		most = with[k] - without[k] > most ? with[k] - without[k] : most;
	for (int k = 0; k < WIDTH * HEIGHT; k++)
		count += 2 * (with[k] - without[k]) > most;
	assert_true(most > 20);
	return count;
}

static void shininess_makes_the_highlight_small(void **state)
{
	const int dull = highlight(20), plain = highlight(80), sharp = highlight(320);

	(void)state;
	assert_true(sharp > 3);
	assert_true(plain > 2 * sharp);
	assert_true(dull > 2 * plain);
	assert_int_equal(highlight(80), plain);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_spot_lights_only_its_cone),
		cmocka_unit_test(a_spot_throws_a_shadow),
		cmocka_unit_test(ambient_light_is_alike_on_all_sides),
		cmocka_unit_test(shininess_makes_the_highlight_small),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
