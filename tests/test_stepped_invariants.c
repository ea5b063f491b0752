/* SPDX-License-Identifier: MIT */
/* src/stepped/stepped_invariants.c */
#include "stepped/stepped_invariants.h"

#include "invariants.h"

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
	struct rb_candidates *const near = &lab.world->stepped->near;
	const struct rb_pair pair = {0, 9};
	const struct rb_pair *const kept = near->pair;
	const size_t count = near->pair_count;

	(void)state;
	near->pair = &pair;
	near->pair_count = 1;
	lab_assert_wrong(&lab, "candidate 0 is of bodies 0 and 9");
	near->pair = kept;
	near->pair_count = count;
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_group_that_sleeps_in_part_is_found, setup,
	                                        teardown),
		cmocka_unit_test_setup_teardown(candidates_of_nobody_are_found, setup, teardown),
		cmocka_unit_test_setup_teardown(a_body_in_the_wrong_list_is_found, setup, teardown),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
