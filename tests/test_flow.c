/* SPDX-License-Identifier: MIT */
/* src/step/flow.c: motion of bodies between contacts */
#include "worlds.h"

#include "step/flow.h"
#include "world/world.h"

/* Three bodies that turn: a ball, a box and another box. */
static void open_three(struct lab *lab)
{
	lab_open(lab, 1, 10);
	for (int i = 0; i < 3; i++) {
		struct rb_body_def def = lab_sphere_def(0.5, 2, (rb_vec3){4.0 * i, 1, -i},
		                                        (rb_vec3){i, -1, 0.5});

		if (i > 0) {
			def.shape = (struct rb_shape){
				.kind = RB_SHAPE_BOX, .solid = -1, .size = {1, 0.5, 0.2 * i}};
			def.call = "box";
		}
		def.angular_velocity = (rb_vec3){1, 2 * i - 1, 0.3};
		lab_add(lab, &def);
	}
	lab_seal(lab, 1);
}

static rb_vec3 momentum_of(const struct lab *lab, int i)
{
	const struct rb_state *const state = &lab->world->state;
	const rb_quat q = rb_quat_from(state->orientation + 4 * i);

	return rb_quat_rotate(
		q, rb_mat3_apply(rb_model_inertia(lab->model, i),
	                         rb_quat_rotate_back(q, rb_vec3_from(state->spin + 3 * i))));
}

static struct rb_pass pass_of(struct lab *lab, const int *member, int count, double h)
{
	return (struct rb_pass){
		.world = lab->world, .member = member, .member_count = count, .h_s = h};
}

static void positions_go_on_with_the_velocities_for_members_alone(void **state)
{
	const int member[] = {0, 2};
	struct lab lab;

	(void)state;
	open_three(&lab);
	struct rb_pass pass = pass_of(&lab, member, 2, 0.25);
	rb_vec3 before[3];
	for (int i = 0; i < 3; i++)
		before[i] = rb_vec3_from(lab.world->state.position + 3 * i);
	rb_stage_translate.run(&pass);
	for (int i = 0; i < 3; i++)
		assert_vector(rb_vec3_from(lab.world->state.position + 3 * i),
		              rb_vec3_add_scaled(before[i], i == 1 ? 0 : 0.25,
		                                 rb_vec3_from(lab.world->state.velocity + 3 * i)),
		              1e-15);
	lab_close(&lab);
}

/* A constant spin is right for any step: one long turn is the same as many short ones. */
static void a_turn_about_a_constant_spin_is_exact(void **state)
{
	const int member[] = {0};
	struct lab one, many;

	(void)state;
	open_three(&one);
	open_three(&many);
	struct rb_pass whole = pass_of(&one, member, 1, 6.4), part = pass_of(&many, member, 1, 0.1);
	rb_stage_rotate.run(&whole);
	for (int k = 0; k < 64; k++)
		rb_stage_rotate.run(&part);
	const rb_quat p = rb_quat_from(one.world->state.orientation),
		      q = rb_quat_from(many.world->state.orientation);
	assert_near(fabs(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z), 1, 1e-14);
	const rb_vec3 x = {1, 0, 0};
	assert_vector(rb_quat_rotate(p, x), rb_quat_rotate(q, x), 1e-13);
	assert_vector(
		rb_quat_rotate(p, x),
		rb_quat_rotate(rb_quat_from_turn(rb_vec3_scale(6.4, (rb_vec3){1, -1, 0.3})), x),
		1e-13);
	lab_close(&one);
	lab_close(&many);
}

static void without_torque_angular_momentum_stays_whatever_the_step(void **state)
{
	const int member[] = {0, 1, 2};
	struct lab lab;

	(void)state;
	open_three(&lab);
	struct rb_pass pass = pass_of(&lab, member, 3, 0.05);
	rb_vec3 before[3], spin = rb_vec3_from(lab.world->state.spin + 3);
	for (int i = 0; i < 3; i++)
		before[i] = momentum_of(&lab, i);
	for (int k = 0; k < 100; k++)
		rb_stage_rotate_gyroscopic.run(&pass);
	for (int i = 0; i < 3; i++) {
		assert_vector(momentum_of(&lab, i), before[i], 1e-13);
		assert_near(rb_quat_length(rb_quat_from(lab.world->state.orientation + 4 * i)), 1,
		            1e-15);
	}
	/* whose axis wanders where its moments are unequal */
	assert_true(rb_vec3_length(rb_vec3_sub(rb_vec3_from(lab.world->state.spin + 3), spin)) >
	            0.1);
	lab_close(&lab);
}

/* Of second order: half the step, a quarter of the error. The reference is a step of 1/64. */
static void the_wandering_axis_is_of_second_order(void **state)
{
	const int member[] = {1};
	rb_vec3 end[3];

	(void)state;
	for (int k = 0; k < 3; k++) {
		const int steps = k == 0 ? 100 : k == 1 ? 200 : 6400;
		struct lab lab;

		open_three(&lab);
		struct rb_pass pass = pass_of(&lab, member, 1, 1.0 / steps);
		for (int s = 0; s < steps; s++)
			rb_stage_rotate_gyroscopic.run(&pass);
		end[k] = rb_vec3_from(lab.world->state.spin + 3);
		lab_close(&lab);
	}
	const double coarse = rb_vec3_length(rb_vec3_sub(end[0], end[2])),
		     fine = rb_vec3_length(rb_vec3_sub(end[1], end[2]));
	assert_true(coarse > 1e-7);
	assert_in_range((int)(100 * coarse / fine), 390, 410);
}

/*
 * Slender and flat bodies, steps of up to some turns: kinetic energy stays, too. Kept angular
 * momentum alone allows |L|^2 / (2 I) of the smallest moment, thousands of times the energy here.
 */
static void without_torque_kinetic_energy_stays_whatever_the_step(void **state)
{
	static const rb_vec3 moments[] = {{1e-3, 2, 2.0005}, {1, 2, 2.5}, {3, 5, 7.9999}};
	static const double steps[] = {1e-3, 0.01, 0.1, 1};
	const int member[] = {0};

	(void)state;
	for (size_t m = 0; m < sizeof moments / sizeof moments[0]; m++)
		for (size_t s = 0; s < sizeof steps / sizeof steps[0]; s++) {
			struct lab lab;
			const rb_vec3 i = moments[m];

			lab_open(&lab, 1, 10);
			struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){0, 0, 0},
			                                        (rb_vec3){0, 0, 0});
			const rb_mat3 inertia = rb_mat3_diagonal(i.x, i.y, i.z);
			def.inertia = &inertia;
			def.angular_velocity = (rb_vec3){20, 20, 10};
			lab_add(&lab, &def);
			lab_seal(&lab, 1);
			struct rb_pass pass = pass_of(&lab, member, 1, steps[s]);
			const rb_vec3 before = momentum_of(&lab, 0);
			for (int k = 0; k < 200; k++)
				rb_stage_rotate_gyroscopic.run(&pass);
			const double energy = 0.5 *
			                      rb_vec3_dot(momentum_of(&lab, 0),
			                                  rb_vec3_from(lab.world->state.spin));
			const double given = 200 * i.x + 200 * i.y + 50 * i.z;
			assert_near(energy / given, 1, 1e-11);
			assert_vector(momentum_of(&lab, 0), before, 1e-11 * rb_vec3_length(before));
			lab_close(&lab);
		}
}

static void stages_need_what_they_change(void **state)
{
	(void)state;
	assert_int_equal(rb_stage_translate.need, 0);
	assert_int_equal(rb_stage_rotate.need, RB_FEATURE_ROTATION);
	assert_int_equal(rb_stage_rotate_gyroscopic.need, RB_FEATURE_GYROSCOPIC);
	assert_true(rb_stage_is_needed(&rb_stage_translate, 0));
	assert_false(rb_stage_is_needed(&rb_stage_rotate, RB_FEATURE_GRAVITY));
	assert_true(rb_stage_is_needed(&rb_stage_rotate, RB_FEATURE_ROTATION | RB_FEATURE_GRAVITY));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(positions_go_on_with_the_velocities_for_members_alone),
		cmocka_unit_test(a_turn_about_a_constant_spin_is_exact),
		cmocka_unit_test(without_torque_angular_momentum_stays_whatever_the_step),
		cmocka_unit_test(the_wandering_axis_is_of_second_order),
		cmocka_unit_test(without_torque_kinetic_energy_stays_whatever_the_step),
		cmocka_unit_test(stages_need_what_they_change),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
