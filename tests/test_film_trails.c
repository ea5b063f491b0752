/* SPDX-License-Identifier: MIT */
/* src/film/trails.c: the paths of bodies, of any length in bounded memory */
#include "worlds.h"

#include <float.h>

#include "film/trails.h"
#include "flow/frame.h"

enum { BALLS = 3 };

struct stage {
	struct lab lab;
	struct rb_frame frame;
	struct rb_camera_def camera;
	struct rb_trails trails;
};

/* Three balls and a plane; `trails` lists ids of them. */
static void open_stage(struct stage *stage, const int *trails, int count)
{
	*stage = (struct stage){.camera = rb_camera_def_default()};
	lab_open(&stage->lab, 1, 10);
	for (int i = 0; i < BALLS; i++) {
		struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){3 * i, 0, 5},
		                                        (rb_vec3){0, 0, 0});
		if (i == 2) { /* its centre of mass is not its middle */
			def.center_of_mass = (rb_vec3){0.25, 0, 0};
			def.angular_velocity = (rb_vec3){0, 0, 1};
		}
		lab_add(&stage->lab, &def);
	}
	lab_plane(&stage->lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	if (rb_model_create(&stage->lab.model, &stage->lab.scene, NULL, &stage->lab.error) != RB_OK)
		fail_msg("%s", stage->lab.error.text);
	assert_int_equal(rb_frame_init(&stage->frame, stage->lab.model, RB_FIELD_DEFAULT, NULL),
	                 RB_OK);
	for (int i = 0; i < count; i++)
		stage->camera.trails[stage->camera.trail_count++] = trails[i];
	assert_int_equal(
		rb_trails_init(&stage->trails, stage->lab.model, &stage->camera, &stage->lab.error),
		RB_OK);
}

static void close_stage(struct stage *stage)
{
	rb_trails_release(&stage->trails);
	rb_trails_release(&stage->trails);
	rb_frame_release(&stage->frame);
	lab_close(&stage->lab);
}

/* Frame k: body i is at (k, i, 0), turned by a quarter about z where k is odd. */
static void add(struct stage *stage, uint64_t k)
{
	stage->frame.index = k;
	stage->frame.time_s = (double)k / 10;
	for (int i = 0; i < BALLS; i++) {
		rb_vec3_to(stage->frame.position + 3 * i, (rb_vec3){(double)k, i, 0});
		if (stage->frame.orientation)
			rb_quat_to(stage->frame.orientation + 4 * i,
			           k % 2 ? (rb_quat){sqrt(0.5), 0, 0, sqrt(0.5)}
			                 : (rb_quat){1, 0, 0, 0});
	}
	rb_trails_add(&stage->trails, &stage->frame);
}

static void paths_go_through_the_centres_of_mass(void **state)
{
	static const int wanted[] = {2, 0};
	struct stage stage;

	(void)state;
	open_stage(&stage, wanted, 2);
	assert_int_equal(stage.trails.path_count, 2);
	for (uint64_t k = 0; k < 10; k++)
		add(&stage, k);
	assert_int_equal(stage.trails.point_count, 10);
	for (int k = 0; k < 10; k++) {
		const double *first = stage.trails.points[0][k],
			     *second = stage.trails.points[1][k];

		assert_true(stage.trails.time_s[k] == k / 10.0);
		/* 0.25 m along its own x, which a quarter turn makes y */
		assert_near(first[0], k + (k % 2 ? 0 : 0.25), 16 * DBL_EPSILON * 10);
		assert_near(first[1], 2 + (k % 2 ? 0.25 : 0), 16 * DBL_EPSILON * 10);
		assert_true(second[0] == k && second[1] == 0 && second[2] == 0);
	}
	close_stage(&stage);
}

/* After any number of frames: the first, and every 2^n-th of all, the smallest n that fits. */
static void a_long_path_is_thinned_out_and_stays_whole(void **state)
{
	static const int wanted[] = {1};
	struct stage stage;
	uint64_t frames = 0;

	(void)state;
	open_stage(&stage, wanted, 1);
	for (int k = 1; k < 12; k++) {
		static const uint64_t ends[] = {0,    1,    2,     4095,  4096,  4097,
		                                8191, 8192, 12289, 16384, 16385, 50000};
		uint64_t stride = 1;

		for (; frames < ends[k]; frames++)
			add(&stage, frames);
		while ((frames + stride - 1) / stride > RB_TRAIL_POINTS_MAX)
			stride *= 2;
		assert_int_equal(stage.trails.stride, stride);
		assert_int_equal(stage.trails.point_count, (frames + stride - 1) / stride);
		for (int i = 0; i < stage.trails.point_count; i++) {
			assert_true(stage.trails.points[0][i][0] == (double)(stride * (uint64_t)i));
			assert_true(stage.trails.time_s[i] == (double)(stride * (uint64_t)i) / 10);
		}
	}
	close_stage(&stage);
}

static void what_never_moves_has_no_path(void **state)
{
	static const int wanted[] = {3, 1, 3}, none[] = {3};
	struct stage stage;

	(void)state;
	open_stage(&stage, wanted, 3);
	assert_int_equal(stage.trails.path_count, 1);
	assert_int_equal(stage.trails.index[0], stage.lab.model->index_of[1]);
	add(&stage, 0);
	assert_true(stage.trails.points[0][0][1] == 1);
	close_stage(&stage);
	open_stage(&stage, none, 1);
	assert_int_equal(stage.trails.path_count, 0);
	add(&stage, 0);
	assert_int_equal(stage.trails.point_count, 0);
	assert_null(stage.trails.points);
	close_stage(&stage);
}

static void a_frame_without_positions_adds_nothing(void **state)
{
	static const int wanted[] = {0};
	struct stage stage;

	(void)state;
	open_stage(&stage, wanted, 1);
	double *const position = stage.frame.position;
	stage.frame.position = NULL;
	rb_trails_add(&stage.trails, &stage.frame);
	assert_int_equal(stage.trails.point_count, 0);
	stage.frame.position = position;
	add(&stage, 5);
	assert_int_equal(stage.trails.point_count, 1);
	close_stage(&stage);
}

static void no_memory_is_told_with_the_number_of_bodies(void **state)
{
	static const int wanted[] = {0, 1};
	struct stage stage;

	(void)state;
	open_stage(&stage, wanted, 2);
	rb_trails_release(&stage.trails);
	for (uint64_t k = 1; k <= 2; k++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_trails_init(&stage.trails, stage.lab.model,
		                                             &stage.camera, &stage.lab.error);
		rb_memory_fail_at(0);
		assert_int_equal(status, RB_ERR_MEMORY);
		assert_string_equal(stage.lab.error.text,
		                    "cannot keep the trails of 2 bodies: out of memory");
		assert_null(stage.trails.points);
	}
	close_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(paths_go_through_the_centres_of_mass),
		cmocka_unit_test(a_long_path_is_thinned_out_and_stays_whole),
		cmocka_unit_test(what_never_moves_has_no_path),
		cmocka_unit_test(a_frame_without_positions_adds_nothing),
		cmocka_unit_test(no_memory_is_told_with_the_number_of_bodies),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
