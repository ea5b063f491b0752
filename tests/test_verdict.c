/* SPDX-License-Identifier: MIT */
/* src/step/verdict.c: whether a substep can stay */
#include "worlds.h"

#include "step/verdict.h"
#include "world/world.h"

static void open_two(struct lab *lab)
{
	lab_open(lab, 1, 10);
	for (int i = 0; i < 2; i++) {
		struct rb_body_def def = lab_sphere_def(0.5, 2, (rb_vec3){4.0 * i, 1, 2},
		                                        (rb_vec3){1, 2, 3});

		def.angular_velocity = (rb_vec3){1, 2, 3};
		lab_add(lab, &def);
	}
	lab_seal(lab, 1);
}

static void any_number_that_is_not_finite_is_seen(void **state)
{
	static const double wrong[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
	struct lab lab;

	(void)state;
	open_two(&lab);
	struct rb_state *const s = &lab.world->state;
	double *const columns[] = {s->position + 3, s->velocity + 3, s->spin + 3};
	assert_true(rb_verdict_finite(s, 0) && rb_verdict_finite(s, 1));
	for (int k = 0; k < 9; k++)
		for (int w = 0; w < 3; w++) {
			double *const number = &columns[k / 3][k % 3];
			const double kept = *number;

			*number = wrong[w];
			assert_false(rb_verdict_finite(s, 1));
			assert_true(rb_verdict_finite(s, 0)); /* of the other */
			*number = kept;
		}
	s->orientation[4] = (double)NAN; /* a unit quaternion is NAN as a whole */
	assert_false(rb_verdict_finite(s, 1));
	lab_close(&lab);
}

/* Their sum overflows: what is computed from them would not be finite. */
static void numbers_that_are_too_large_together_are_as_bad(void **state)
{
	struct lab lab;

	(void)state;
	open_two(&lab);
	lab.world->state.velocity[0] = lab.world->state.velocity[1] = 1.7e308;
	assert_false(rb_verdict_finite(&lab.world->state, 0));
	lab_close(&lab);
}

static void an_overlap_counts_unless_nothing_is_restored(void **state)
{
	const int member[] = {0, 1};
	int body = -1;
	struct lab lab;

	(void)state;
	open_two(&lab);
	struct rb_pass pass = {.world = lab.world,
	                       .member = member,
	                       .member_count = 2,
	                       .touch_count = 1,
	                       .worst = -1};
	assert_int_equal(rb_verdict_of(&pass, &body), RB_VERDICT_GOOD);
	pass.worst = 0;
	assert_int_equal(rb_verdict_of(&pass, &body), RB_VERDICT_OVERLAP);
	lab.model->rollback = RB_ROLLBACK_NONE;
	assert_int_equal(rb_verdict_of(&pass, &body), RB_VERDICT_GOOD);
	lab.model->rollback = RB_ROLLBACK_SELECTIVE;
	pass.touch_count = 0; /* then `worst` says nothing */
	assert_int_equal(rb_verdict_of(&pass, &body), RB_VERDICT_GOOD);
	assert_int_equal(body, -1);
	lab_close(&lab);
}

static void the_first_member_that_is_not_finite_is_named_before_overlaps(void **state)
{
	const int member[] = {0, 1};
	int body = -1;
	struct lab lab;

	(void)state;
	open_two(&lab);
	struct rb_pass pass = {.world = lab.world,
	                       .member = member,
	                       .member_count = 2,
	                       .touch_count = 1,
	                       .worst = 0};
	lab.world->state.velocity[3] = (double)NAN;
	assert_int_equal(rb_verdict_of(&pass, &body), RB_VERDICT_NOT_FINITE);
	assert_int_equal(body, 1);
	pass.member_count = 1; /* the bad one is of another group */
	assert_int_equal(rb_verdict_of(&pass, &body), RB_VERDICT_OVERLAP);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_number_that_is_not_finite_is_seen),
		cmocka_unit_test(numbers_that_are_too_large_together_are_as_bad),
		cmocka_unit_test(an_overlap_counts_unless_nothing_is_restored),
		cmocka_unit_test(the_first_member_that_is_not_finite_is_named_before_overlaps),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
