/* SPDX-License-Identifier: MIT */
/* src/stepped/pivot.h: two bodies that turn together */
#include "worlds.h"

#include "stepped/pivot.h"

static const rb_vec3 up = {0, 0, 1};

static void turning_by_a_share_of_one_is_the_rotation(void **state)
{
	(void)state;
	for (int k = 0; k < 60; k++) {
		const rb_vec3 n = rb_vec3_unit((rb_vec3){sin(k), cos(2 * k), 0.3}, up);
		const rb_vec3 v = {cos(3 * k), 2 * sin(k), cos(k)};
		const double angle = 0.2 * (k - 30);

		assert_vector(rb_pivot_turn(v, n, rb_pivot_of(angle)),
		              rb_quat_rotate(rb_quat_from_turn(rb_vec3_scale(angle, n)), v), 1e-14);
		/* what is along the normal stays, what is across is scaled */
		const rb_vec3 half = rb_pivot_turn(v, n,
		                                   (rb_pivot){0.5 * cos(angle), 0.5 * sin(angle)});
		assert_near(rb_vec3_dot(half, n), rb_vec3_dot(v, n), 1e-15);
		assert_near(rb_vec3_length(rb_vec3_reject(half, n)),
		            0.5 * rb_vec3_length(rb_vec3_reject(v, n)), 1e-14);
	}
}

/* The promise of the header: (R(angle) - 1) arm = angle normal x mean. */
static void the_mean_arm_moves_along_the_chord(void **state)
{
	(void)state;
	for (int k = 0; k < 60; k++) {
		const rb_vec3 n = rb_vec3_unit((rb_vec3){sin(k), cos(2 * k), 0.3}, up);
		const rb_vec3 arm = {cos(3 * k), 2 * sin(k), cos(k)};
		const double angle = (k % 2 ? 1 : -1) * exp2(1 - k);
		const rb_vec3 turned = rb_quat_rotate(rb_quat_from_turn(rb_vec3_scale(angle, n)),
		                                      arm);
		const rb_vec3 mean = rb_pivot_turn(arm, n, rb_pivot_mean(angle));

		assert_vector(rb_vec3_scale(angle, rb_vec3_cross(n, mean)),
		              rb_vec3_sub(turned, arm), 1e-15);
	}
}

/* And it is the mean over the step, by Simpson's rule, whose error is of the fourth order. */
static void the_mean_arm_is_the_mean_over_the_step(void **state)
{
	enum { PARTS = 200 };
	const rb_vec3 arm = {1, 0.5, -0.3};

	(void)state;
	for (int k = 1; k < 6; k++) {
		const double angle = 0.5 * k;
		rb_vec3 mean = {0, 0, 0};

		for (int i = 0; i <= PARTS; i++) {
			const double weight = i == 0 || i == PARTS ? 1 : i % 2 ? 4 : 2;

			mean = rb_vec3_add_scaled(
				mean, weight / (3 * PARTS),
				rb_pivot_turn(arm, up, rb_pivot_of(angle * i / PARTS)));
		}
		assert_vector(rb_pivot_turn(arm, up, rb_pivot_mean(angle)), mean, 1e-9);
	}
}

static double angle_of(struct lab *lab, double a, double b)
{
	double *const spin = lab->world->state.spin;

	rb_vec3_to(spin, (rb_vec3){7, 0, a});
	rb_vec3_to(spin + 3, (rb_vec3){0, -9, b});
	return rb_pivot_angle(lab->world, 0, 1, up, 0.1);
}

static void they_turn_together_by_the_lesser_of_both_if_alike(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (int i = 0; i < 2; i++) {
		struct rb_body_def def = lab_sphere_def(0.1, 1, (rb_vec3){i, 0, 0},
		                                        (rb_vec3){0, 0, 0});

		def.angular_velocity = (rb_vec3){0, 0, 1};
		lab_add(&lab, &def);
	}
	lab_plane(&lab, (rb_vec3){0, 0, -5}, up);
	lab_seal(&lab, 1);
	assert_near(angle_of(&lab, 2, 5), 0.2, 1e-15);
	assert_near(angle_of(&lab, 5, 2), 0.2, 1e-15);
	assert_near(angle_of(&lab, -5, -2), -0.2, 1e-15);
	assert_near(angle_of(&lab, 5, -2), 0, 0);
	assert_near(angle_of(&lab, 5, 0), 0, 0);
	assert_near(angle_of(&lab, (double)NAN, 1), 0, 0);
	/* what never moves turns with nobody */
	assert_near(rb_pivot_angle(lab.world, 0, 2, up, 0.1), 0, 0);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(turning_by_a_share_of_one_is_the_rotation),
		cmocka_unit_test(the_mean_arm_moves_along_the_chord),
		cmocka_unit_test(the_mean_arm_is_the_mean_over_the_step),
		cmocka_unit_test(they_turn_together_by_the_lesser_of_both_if_alike),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
