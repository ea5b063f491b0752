/* SPDX-License-Identifier: MIT */
/* src/math/pose.h: all of a body at one moment */
#include "worlds.h"

#include "math/pose.h"

static void near_the_origin_it_is_the_difference(void **state)
{
	const struct rb_pose a = {.position = {1, 2, 3}}, b = {.position = {4, 6, 3.5}};

	(void)state;
	assert_vector(rb_pose_between(&a, &b), ((rb_vec3){3, 4, 0.5}), 0);
	assert_vector(rb_pose_between(&b, &a), ((rb_vec3){-3, -4, -0.5}), 0);
}

/* Where an ulp of the position is a millimetre, what rounding has left stands in the rest. */
static void far_away_it_is_as_exact_with_what_rounding_has_left(void **state)
{
	const rb_vec3 far = {0x1p43, -0x1p43, 0x1p43};

	(void)state;
	for (int k = 1; k < 50; k++) {
		const rb_vec3 small[2] = {{sin(k), cos(k), 0.1 * k},
		                          {cos(2 * k), sin(3 * k), -0.2 * k}};
		struct rb_pose pose[2];

		for (int i = 0; i < 2; i++) {
			pose[i] = (struct rb_pose){.position = rb_vec3_add(far, small[i])};
			pose[i].rest = rb_vec3_lost(far, small[i], pose[i].position);
		}
		const rb_vec3 way = rb_vec3_sub(small[1], small[0]);
		assert_vector(rb_pose_between(&pose[0], &pose[1]), way, 4e-15);
		/* the positions alone have lost it */
		const rb_vec3 plain = rb_vec3_sub(pose[1].position, pose[0].position);
		assert_true(rb_vec3_length(rb_vec3_sub(plain, way)) > 1e-7);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(near_the_origin_it_is_the_difference),
		cmocka_unit_test(far_away_it_is_as_exact_with_what_rounding_has_left),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
