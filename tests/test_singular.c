/* SPDX-License-Identifier: MIT */
/* located/singular.c: closed mechanisms that pass positions at which their joints depend on each other. */
#include "jointed.h"

#include "method/numbers.h"

enum { LEFT, RIGHT, LEVEL };

/*
 * Thin bars of 1 kg on hinges across x and z: two of 1 m that turn about their ends with 30 rad/s,
 * `angle` from upright, and one of `length` between their other ends.
 */
static void open_bars(struct lab *lab, double angle, double length)
{
	const rb_vec3 up = {sin(angle), 0, cos(angle)};
	const double speed = 30;

	lab_open_located(lab, 0.25, 20);
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	for (int k = LEFT; k <= LEVEL; k++) {
		const double size = k == LEVEL ? length : 1;
		const rb_vec3 along = k == LEVEL ? (rb_vec3){1, 0, 0} : up;
		const rb_vec3 foot = k == LEFT    ? (rb_vec3){0, 0, 0}
		                     : k == RIGHT ? (rb_vec3){length, 0, 0}
		                                  : up;
		struct rb_body_def def = lab_sphere_def(
			0.01, 1, rb_vec3_add_scaled(foot, 0.5 * size, along), (rb_vec3){0, 0, 0});

		const rb_mat3 moments = rb_mat3_diagonal(1e-5, 1.0 / 12, 1.0 / 12);
		def.inertia = &moments;
		def.orientation = rb_quat_from_turn(
			(rb_vec3){0, k == LEVEL ? 0 : angle - acos(0), 0});
		def.velocity = rb_vec3_scale(k == LEVEL ? speed : 0.5 * speed,
		                             (rb_vec3){up.z, 0, -up.x});
		def.angular_velocity.y = k == LEVEL ? 0 : speed;
		lab_add(lab, &def);
	}
	for (int k = 0; k < 4; k++) {
		const bool right = k % 2 == 1, grounded = k < 2;
		struct rb_joint_def def = jointed_def(RB_JOINT_HINGE, right ? RIGHT : LEFT,
		                                      grounded ? -1 : LEVEL);
		const rb_vec3 foot = {right ? length : 0, 0, 0};

		def.at = grounded ? foot : rb_vec3_add(foot, up);
		def.axis = (rb_vec3){0, 1, 0};
		jointed_add(lab, def);
	}
	lab_seal(lab, 1);
}

/*
 * Twice in 0.25 s all bars lie in one line, from which the two could also turn against each other.
 * The level bar stays level: of angles by what is left of a position there, the root of rounding,
 * next to nothing; and energy stays, where a piece past such a position may be off by 2^-28, but by
 * its square only.
 */
static void bars_pass_the_line_in_which_they_all_lie(void **state)
{
	const double quarter = acos(0);
	const double angle[] = {0, 1, 2, quarter, -quarter, 1.5};

	(void)state;
	for (size_t k = 0; k < sizeof angle / sizeof *angle; k++) {
		struct rb_frame_numbers first = {0}, last = {0};
		struct lab lab;

		open_bars(&lab, angle[k], k % 2 ? 0.5 : 1);
		rb_numbers_measure(lab.world, &first);
		while (lab.world->state.frame + 1 < lab.model->frame_count)
			if (rb_world_step_frame(lab.world, &lab.error) != RB_OK)
				fail_msg("%s", lab.error.text);
		rb_numbers_measure(lab.world, &last);
		const rb_quat q = rb_quat_from(lab.world->state.orientation + 4 * LEVEL);
		const double lost = last.kinetic_energy + last.potential_energy -
		                    first.kinetic_energy - first.potential_energy;
		print_message("angle %.3g: energy %.2g, level %.2g\n", angle[k],
		              lost / first.kinetic_energy, q.y);
		assert_near(lost / first.kinetic_energy, 0, 1e-12);
		assert_near(q.y, 0, 1e-12);
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bars_pass_the_line_in_which_they_all_lie),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
