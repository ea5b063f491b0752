/* SPDX-License-Identifier: MIT */
/* src/film/take.c, src/film/trails.c: what is written over a picture, and the paths in it */
#include "filmset.h"

#include "film/take.h"

/* ---- what is written over a picture ---- */

/* Left, right, top and bottom of what an overlay changes in the picture at a time. */
static void written_at(struct set *set, unsigned overlay, double time_s, int box[4])
{
	struct rb_pixmap plain = {0}, picture;
	struct rb_take *take;
	struct rb_error err;

	set->frame.time_s = time_s;
	set->frame.numbers.kinetic_energy = 4.5;
	set->frame.numbers.potential_energy = 8;
	box[0] = box[2] = 1000, box[1] = box[3] = -1;
	for (int way = 0; way < 2; way++) {
		set->camera.overlay = way ? overlay : 0;
		assert_ok(rb_take_create(&take, set->lab.model, &set->camera, &err));
		rb_take_see(take, &set->frame);
		assert_ok(rb_take_draw(take, &set->frame, NULL, &picture, &err));
		if (way == 0) {
			assert_ok(rb_pixmap_init(&plain, picture.width, picture.height, &err));
			memcpy(plain.rgba, picture.rgba,
			       4 * (size_t)(picture.width * picture.height));
		}
		for (int i = 0; i < picture.width * picture.height; i++) {
			const int x = i % picture.width, y = i / picture.width;
			if (memcmp(plain.rgba + 4 * i, picture.rgba + 4 * i, 4) == 0)
				continue;
			box[0] = x < box[0] ? x : box[0], box[1] = x > box[1] ? x : box[1];
			box[2] = y < box[2] ? y : box[2], box[3] = y > box[3] ? y : box[3];
		}
		rb_take_destroy(take);
	}
	rb_pixmap_release(&plain);
}

static void each_text_has_its_corner_and_does_not_move_as_time_goes_on(void **state)
{
	int title[4], early[4], late[4], slow[4], energy[4];
	struct set set;

	(void)state;
	open_set(&set);
	set.camera.size_px[0] = 480;
	set.camera.size_px[1] = 240;
	rb_model_destroy(set.lab.model);
	set.lab.scene.world.duration_s = 100;
	assert_int_equal(rb_model_create(&set.lab.model, &set.lab.scene, NULL, NULL), RB_OK);
	written_at(&set, RB_OVERLAY_TITLE, 1, title);
	assert_true(title[0] < 40 && title[1] < 240 && title[1] > 30 && title[3] < 60);
	written_at(&set, RB_OVERLAY_TIME, 1.25, early);
	written_at(&set, RB_OVERLAY_TIME, 98.75, late);
	assert_true(early[0] < 40 && early[1] < 240 && early[1] > 30 && early[2] > 180);
	assert_int_equal(early[1], late[1]);
	assert_int_equal(early[0], late[0]);
	written_at(&set, RB_OVERLAY_ENERGY, 1, energy);
	assert_true(energy[0] > 200 && energy[1] > 440 && energy[2] > 180);
	/* another speed is said beside the time */
	set.camera.speed = 0.25;
	written_at(&set, RB_OVERLAY_TIME, 1.25, slow);
	assert_true(slow[1] > early[1] + 50);
	close_set(&set);
}

static void texts_of_a_narrow_picture_stand_one_above_the_other(void **state)
{
	int time[4], energy[4], both[4];
	struct set set;

	(void)state;
	open_set(&set);
	set.camera.size_px[0] = 200;
	set.camera.size_px[1] = 540;
	set.camera.speed = 0.25;
	written_at(&set, RB_OVERLAY_TIME, 1, time);
	written_at(&set, RB_OVERLAY_ENERGY, 1, energy);
	written_at(&set, RB_OVERLAY_TIME | RB_OVERLAY_ENERGY, 1, both);
	/* each alone stands at the bottom, and they would be over each other */
	assert_true(time[3] > 520 && energy[3] > 520 && time[1] > energy[0]);
	assert_true(time[0] > 0 && energy[0] > 0 && energy[1] < 199);
	assert_true(time[3] - time[2] < 20);
	assert_true(both[3] == time[3] || both[3] == energy[3]);
	assert_true(energy[2] - both[2] > 8);
	/* where there is room they stay side by side */
	set.camera.size_px[0] = 960;
	written_at(&set, RB_OVERLAY_TIME, 1, time);
	written_at(&set, RB_OVERLAY_TIME | RB_OVERLAY_ENERGY, 1, both);
	assert_true(time[2] - both[2] < 8);
	/* so do the title and the bar of the scale */
	int scale[4];
	rb_model_destroy(set.lab.model);
	set.lab.scene.world.title = "A title that takes a good part of the width, but not all";
	assert_int_equal(rb_model_create(&set.lab.model, &set.lab.scene, NULL, NULL), RB_OK);
	written_at(&set, RB_OVERLAY_SCALE, 1, scale);
	written_at(&set, RB_OVERLAY_TITLE | RB_OVERLAY_SCALE, 1, both);
	assert_int_equal(both[3], scale[3]);
	set.camera.size_px[0] = 240;
	written_at(&set, RB_OVERLAY_SCALE, 1, scale);
	written_at(&set, RB_OVERLAY_TITLE | RB_OVERLAY_SCALE, 1, both);
	assert_true(both[3] - scale[3] > 8);
	close_set(&set);
}

/* ---- trails ---- */

static void a_path_stays_whole_and_bounded_however_long_the_run(void **state)
{
	struct set set;
	struct rb_trails trails;
	struct rb_error err;

	(void)state;
	open_set(&set);
	set.camera.trail_count = 1;
	set.camera.trails[0] = 0;
	assert_ok(rb_trails_init(&trails, set.lab.model, &set.camera, &err));
	assert_int_equal(trails.path_count, 1);
	for (int k = 0; k < 3 * RB_TRAIL_POINTS_MAX; k++) {
		set.frame.time_s = k / rate;
		set.frame.position[0] = k;
		rb_trails_add(&trails, &set.frame);
		assert_true(trails.point_count <= RB_TRAIL_POINTS_MAX);
	}
	assert_int_equal(trails.stride, 4);
	assert_int_equal(trails.point_count, 3 * RB_TRAIL_POINTS_MAX / 4);
	for (int i = 0; i < trails.point_count; i++) {
		assert_true(trails.points[0][i][0] == 4 * i);
		assert_true(trails.time_s[i] == 4 * i / rate);
	}
	rb_trails_release(&trails);
	rb_trails_release(&trails);
	close_set(&set);
}

static void a_trail_follows_the_centre_of_mass_and_skips_what_never_moves(void **state)
{
	struct set set;
	struct rb_trails trails;
	struct rb_error err;

	(void)state;
	open_set(&set);
	rb_model_destroy(set.lab.model);
	const int wall = lab_plane(&set.lab, (rb_vec3){0, 0, -9}, (rb_vec3){0, 0, 1});
	struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){3, 0, 0}, (rb_vec3){0});
	def.center_of_mass = (rb_vec3){0.1, 0, 0};
	def.angular_velocity = (rb_vec3){0, 0, 1};
	const int ball = lab_add(&set.lab, &def);
	assert_ok(rb_model_create(&set.lab.model, &set.lab.scene, NULL, &err));
	rb_frame_release(&set.frame);
	assert_ok(rb_frame_init(&set.frame, set.lab.model, RB_FIELD_DEFAULT, &err));
	set.camera.trail_count = 2;
	set.camera.trails[0] = wall;
	set.camera.trails[1] = ball;
	assert_ok(rb_trails_init(&trails, set.lab.model, &set.camera, &err));
	assert_int_equal(trails.path_count, 1);
	const int index = set.lab.model->index_of[ball];
	rb_vec3_to(set.frame.position + 3 * index, (rb_vec3){5, 6, 7});
	rb_quat_to(set.frame.orientation + 4 * index,
	           rb_quat_from_turn((rb_vec3){0, 0, 1.5707963267948966}));
	rb_trails_add(&trails, &set.frame);
	assert_near(trails.points[0][0][0], 5, 1e-15);
	assert_near(trails.points[0][0][1], 6.1, 1e-15);
	rb_trails_release(&trails);
	close_set(&set);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_text_has_its_corner_and_does_not_move_as_time_goes_on),
		cmocka_unit_test(texts_of_a_narrow_picture_stand_one_above_the_other),
		cmocka_unit_test(a_path_stays_whole_and_bounded_however_long_the_run),
		cmocka_unit_test(a_trail_follows_the_centre_of_mass_and_skips_what_never_moves),
	};

	return cmocka_run_group_tests_name("film_take", tests, NULL, NULL);
}
