/* SPDX-License-Identifier: MIT */
/* src/stepped/dual: rows with bounds, several of them on one coordinate. */
#include "worlds.h"

#include "stepped/joint_steps.h"
#include "world/world.h"

static const rb_vec3 nothing = {0, 0, 0};

static void open_stepped(struct lab *lab, double duration, double frame_rate, double time_step)
{
	lab_open(lab, duration, frame_rate);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = time_step;
	lab->scene.world.gravity = nothing;
}

static int add_joint(struct lab *lab, const struct rb_joint_def *def)
{
	int index = -1;

	assert_int_equal(rb_scene_add_joint(&lab->scene, def, &index, &lab->error), RB_OK);
	return index;
}

static double drift(const struct lab *lab)
{
	struct rb_step_joint of;
	double max = 0;

	for (int k = 0; k < lab->model->joints->count; k++)
		max = fmax(max, rb_joints_error(lab->world, k, &of, NULL));
	return max;
}

/* Runs to the end; in every frame joints hold within the tolerance. */
static void run_held(struct lab *lab)
{
	while (rb_world_frame(lab->world) + 1 < rb_world_frame_count(lab->world)) {
		lab_step(lab);
		assert_true(drift(lab) <= lab->model->tolerance_m);
	}
}

/*
 * A ball of 1 kg on a line under friction, a weak motor and a strong one, defined in any order; then
 * held by a rope.
 */
static void bounds_on_one_line_act_in_any_order(void **state)
{
	static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
	                                {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
	static const double speed[3] = {NAN, -2, 1}, most[3] = {0.1, 3, 20};

	(void)state;
	for (int k = 0; k < 12; k++) {
		struct rb_joint_def def = rb_joint_def_default();
		struct lab lab;

		open_stepped(&lab, 1, 60, 1.0 / 240);
		const int ball = lab_sphere(&lab, 0.1, 1, nothing, nothing);
		def.a = ball;
		def.at_b = (rb_vec3){-0.5, 0, 0};
		def.kind = RB_JOINT_ROPE;
		def.length_m = 1;
		if (k >= 6)
			add_joint(&lab, &def);
		for (int j = 0; j < 3; j++) {
			const int part = order[k % 6][j];

			def = rb_joint_def_default();
			def.kind = RB_JOINT_SLIDER;
			def.a = ball;
			def.at = nothing;
			/* of a against b, the world */
			def.axis = (rb_vec3){-1, 0, 0};
			def.motor_speed = speed[part];
			def.friction = part == 0 ? most[part] : 0;
			def.motor_max = part == 0 ? 0 : most[part];
			add_joint(&lab, &def);
		}
		lab_seal(&lab, 1);
		run_held(&lab);
		assert_near(rb_world_velocity(lab.world, 0).x, k < 6 ? 1 : 0, 1e-9);
		if (k >= 6)
			assert_near(rb_world_position(lab.world, 0).x, 0.5, 1e-6);
		lab_close(&lab);
	}
}

/* A ball at the end of an arm: the motor's row and the limit's differ by rounding. */
static void a_motor_holds_an_arm_at_its_limit(void **state)
{
	struct rb_joint_def def = rb_joint_def_default();
	struct lab lab;

	(void)state;
	for (int torque = 1; torque <= 20; torque++) {
		open_stepped(&lab, 2, 60, 1.0 / 240);
		def.kind = RB_JOINT_HINGE;
		def.a = lab_sphere(&lab, 0.1, 1, (rb_vec3){1, 0, 0}, nothing);
		def.at = nothing;
		def.axis = (rb_vec3){0, 0, -1};
		def.motor_speed = 1;
		def.motor_max = torque;
		def.limits[0] = -1;
		def.limits[1] = 0.5;
		add_joint(&lab, &def);
		lab_seal(&lab, 1);
		run_held(&lab);
		assert_near(lab.world->stepped->solver.joint[0].last.way, 0.5, 1e-6);
		assert_near(rb_vec3_length(rb_world_velocity(lab.world, 0)), 0, 1e-9);
		lab_close(&lab);
	}
}

/* A motor, though stronger than a step needs, against a joint that holds what it would turn. */
static void what_is_fixed_holds_a_motor_in_any_order(void **state)
{
	(void)state;
	for (int motor_first = 0; motor_first <= 1; motor_first++) {
		struct rb_joint_def def = rb_joint_def_default();
		struct lab lab;

		open_stepped(&lab, 1, 60, 1.0 / 240);
		def.a = lab_box(&lab, (rb_vec3){0.2, 0.3, 0.4}, 1, nothing, (rb_quat){1, 0, 0, 0});
		def.at = nothing;
		def.axis = (rb_vec3){0, 0, 1};
		for (int k = 0; k < 2; k++) {
			const bool is_motor = (k == 0) == (motor_first == 1);

			def.kind = is_motor ? RB_JOINT_HINGE : RB_JOINT_FIXED;
			def.motor_speed = is_motor ? 3 : (double)NAN;
			def.motor_max = is_motor ? 50 : 0;
			add_joint(&lab, &def);
		}
		lab_seal(&lab, 1);
		run_held(&lab);
		assert_near(rb_vec3_length(rb_world_angular_velocity(lab.world, 0)), 0, 1e-9);
		/* in whole steps */
		assert_int_equal(
			lab.world->total_counts.rollbacks + lab.world->frame_counts.rollbacks, 0);
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bounds_on_one_line_act_in_any_order),
		cmocka_unit_test(a_motor_holds_an_arm_at_its_limit),
		cmocka_unit_test(what_is_fixed_holds_a_motor_in_any_order),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
