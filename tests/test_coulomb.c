/* SPDX-License-Identifier: MIT */
#include "piles.h"

/*
 * A face on a plane, with more points than its three freedoms, which differ in acceleration by little. Forces that hold all of
 * them do not exist; what comes nearest is found by Newton steps, each of a few products for each row, and not again and again.
 */
static void points_of_a_face_that_contradict_each_other_are_given_up_soon(void **state)
{
	const rb_vec3 gravity = {0.3, 0.1, -9.81};
	const double contradiction = 1e-10;

	(void)state;
	for (int points = 4; points < 12; points++) {
		struct pile p;

		pile_open(&p, 1, points);
		ball(&p, 1, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
		for (int k = 0; k < points; k++) {
			struct rb_solver_contact *c = plane(&p, 1, (rb_vec3){0, 0, 1}, 0, 0);

			c->arm_a = (rb_vec3){cos(k), sin(k), -1};
			c->bias = (rb_vec3){0, 0, contradiction * sin(k * k)};
		}
		assert_true(load(&p, gravity) <= 2 * contradiction);
		assert_true(p.joint.products <= 32 * points * points);
		pile_close(&p);
	}
}

/* Two rows of a joint that carry the same: as they are guessed to share it, within their bounds. */
static void forces_of_joints_begin_with_a_guess(void **state)
{
	struct rb_cone_row row[2];
	struct pile p;

	(void)state;
	pile_open(&p, 1, 0);
	ball(&p, 1, 2, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	for (int k = 0; k < 2; k++) {
		row[k] = (struct rb_cone_row){.base = {.b = 1,
		                                       .set = RB_CONSTRAINT_INTERVAL,
		                                       .normal = {0, 0, 1},
		                                       .low = -7,
		                                       .high = 7}};
		row[k].base.impulse.n = k == 0 ? 9 : 3;
	}
	p.joint.joint_row = row;
	p.joint.joint_count = 2;
	assert_true(load(&p, (rb_vec3){0, 0, -5}) <= 1e-14);
	assert_near(row[0].base.impulse.n, 7, 1e-14);
	assert_near(row[1].base.impulse.n, 3, 1e-14);
	pile_close(&p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_of_a_face_that_contradict_each_other_are_given_up_soon),
		cmocka_unit_test(forces_of_joints_begin_with_a_guess),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
