/* SPDX-License-Identifier: MIT */
/* src/stepped/stepped_invariants.c */
#include "stepped/stepped_invariants.h"

#include "invariants.h"
#include "math/random.h"

static struct lab lab;

static int setup(void **state)
{
	(void)state;
	lab_open_pile(&lab, RB_METHOD_STEPPED);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	lab_close(&lab);
	return 0;
}

static void a_group_that_sleeps_in_part_is_found(void **state)
{
	struct rb_sleep *const sleep = &lab.world->stepped->sleep;

	(void)state;
	assert_true(sleep->count == 3 && sleep->sleeps[1]);
	sleep->sleeps[1] = 0;
	lab_assert_wrong(&lab, "sleeps");
	sleep->sleeps[1] = 1;
	sleep->point_count++;
	lab_assert_wrong(&lab, "counted are");
	sleep->point_count--;
	sleep->mark[2] = 1;
	lab_assert_wrong(&lab, "a mark is left on body 2");
	sleep->mark[2] = 0;
	assert_int_equal(rb_world_validate(lab.world, &lab.error), RB_OK);
}

static void candidates_of_nobody_are_found(void **state)
{
	struct rb_candidates *const candidates = &lab.world->stepped->candidates;
	const struct rb_pair pair = {0, 9};
	const struct rb_pair *const kept = candidates->pair;
	const size_t count = candidates->pair_count;

	(void)state;
	candidates->pair = &pair;
	candidates->pair_count = 1;
	lab_assert_wrong(&lab, "candidate 0 is of bodies 0 and 9");
	candidates->pair = kept;
	candidates->pair_count = count;
}

static void a_body_in_the_wrong_list_is_found(void **state)
{
	struct rb_stepped *const s = lab.world->stepped;
	const int kept = s->body[0];

	(void)state;
	s->body[0] = s->body[1];
	lab_assert_wrong(&lab, "out of order");
	s->body[0] = kept;
	s->member_count--;
	lab_assert_wrong(&lab, "yield");
	s->member_count++;
}

/* A heap that is shaken: impacts turn normals of contacts whose friction is known from the step before. */
static void friction_stays_across_the_normal(void **state)
{
	(void)state;
	lab_open(&lab, 0.5, 100);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.gravity = (rb_vec3){0, 0, -10};
	lab.scene.world.time_step_s = 0.002;
	lab_surface(&lab, 2, 0.4);
	for (unsigned i = 0; i < 24; i++)
		lab_sphere(&lab, 0.1 + 0.05 * rb_random_unit(7, 0, i),
		           1 + 9 * rb_random_unit(7, 1, i),
		           (rb_vec3){0.3 * (i % 3) - 0.3, 0.3 * (i / 3 % 3) - 0.3,
		                     0.3 + 0.4 * (i / 9)},
		           (rb_vec3){0, 0, -2});
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0.3, 0, 1});
	lab_plane(&lab, (rb_vec3){1, 0, 0}, (rb_vec3){-1, 0.2, 0.2});
	lab_seal(&lab, 1);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		if (rb_world_validate(lab.world, &lab.error) != RB_OK)
			fail_msg("%s", lab.error.text);
	}
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_group_that_sleeps_in_part_is_found, setup,
	                                        teardown),
		cmocka_unit_test_setup_teardown(candidates_of_nobody_are_found, setup, teardown),
		cmocka_unit_test(friction_stays_across_the_normal),
		cmocka_unit_test_setup_teardown(a_body_in_the_wrong_list_is_found, setup, teardown),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
