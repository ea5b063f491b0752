/* SPDX-License-Identifier: MIT */
/* src/step/force_stages.c: what changes velocities other than contact */
#include "worlds.h"

#include "step/force_stages.h"
#include "world/world.h"

static const int both[] = {0, 1};

/* A ball, and one with its centre of mass aside; `force` is the second one's. */
static void open_two(struct lab *lab, const struct rb_force_def *force)
{
	lab_open(lab, 1, 10);
	lab->scene.world.gravity = (rb_vec3){0, 0, -10};
	lab->scene.world.gravity_force = (rb_vec3){3, 0, 0};
	lab_sphere(lab, 0.5, 2, (rb_vec3){-3, 0, 0}, (rb_vec3){0, 0, 0});
	struct rb_body_def def = lab_sphere_def(0.5, 4, (rb_vec3){3, 0, 0}, (rb_vec3){0, 0, 0});
	def.angular_velocity = (rb_vec3){0, 0, 1e-3};
	def.orientation = rb_quat_from_turn((rb_vec3){0, 0, 1.5707963267948966}); /* x to y */
	def.center_of_mass = (rb_vec3){0.1, 0, 0};
	lab_add(lab, &def);
	if (force) /* of the body that was added last */
		assert_int_equal(rb_scene_add_force(&lab->scene, force, &lab->error), RB_OK);
	lab_seal(lab, 1);
}

static struct rb_pass pass_of(struct lab *lab, double start_s, double h_s)
{
	return (struct rb_pass){.world = lab->world,
	                        .member = both,
	                        .member_count = 2,
	                        .start_s = start_s,
	                        .dt_s = h_s,
	                        .h_s = h_s};
}

static void gravity_is_an_acceleration_and_gravity_force_a_force(void **state)
{
	struct lab lab;

	(void)state;
	open_two(&lab, NULL);
	struct rb_pass pass = pass_of(&lab, 0, 0.5);
	rb_stage_gravity.run(&pass);
	for (int i = 0; i < 2; i++)
		assert_vector(rb_vec3_from(lab.world->state.velocity + 3 * i),
		              ((rb_vec3){0, 0, -5}), 1e-15);
	rb_stage_gravity_force.run(&pass);
	assert_vector(rb_vec3_from(lab.world->state.velocity), ((rb_vec3){0.75, 0, -5}), 1e-15);
	assert_vector(rb_vec3_from(lab.world->state.velocity + 3), ((rb_vec3){0.375, 0, -5}),
	              1e-15);
	lab_close(&lab);
}

/* Of a force from 1 to 1.5 s, what of the step it covers. */
static void a_force_acts_in_its_time_and_no_longer(void **state)
{
	static const double steps[][3] = {
		{0, 0.5, 0},   {0.5, 0.5, 0},   {0.75, 0.5, 0.25}, {1, 0.25, 0.25}, {1, 2, 0.5},
		{0.5, 2, 0.5}, {1.25, 1, 0.25}, {1.5, 1, 0},       {2, 1, 0},       {1.1, 0.2, 0.2},
	};
	struct rb_force_def force = rb_force_def_default();
	struct lab lab;

	(void)state;
	force.vector = (rb_vec3){0, 8, 0};
	force.start_s = 1;
	force.duration_s = 0.5;
	open_two(&lab, &force);
	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
		const struct rb_pass pass = pass_of(&lab, steps[k][0], steps[k][1]);
		const struct rb_force_impulse out = rb_forces_stated(&pass, &lab.world->state, 1,
		                                                     0);

		assert_vector(out.impulse, ((rb_vec3){0, 8 * steps[k][2], 0}), 1e-15 * 8);
		assert_vector(out.turn, ((rb_vec3){0, 0, 0}), 0); /* at the centre of mass */
		assert_int_equal(out.cause, RB_MOMENTUM_APPLIED);
	}
	lab_close(&lab);
}

/* The point is in object coordinates, its arm from the centre of mass; the body is turned by a quarter. */
static void a_force_at_a_point_turns_by_its_arm(void **state)
{
	struct rb_force_def force = rb_force_def_default();

	(void)state;
	force.vector = (rb_vec3){0, 0, 6};
	force.torque = (rb_vec3){0, 0, 1};
	force.point = (rb_vec3){0.3, 0, 0}; /* 0.2 from the centre of mass, along the world's y */
	for (int frame = 0; frame < 2; frame++) {
		struct lab lab;

		force.frame = frame ? RB_FORCE_BODY : RB_FORCE_WORLD;
		force.vector = frame ? (rb_vec3){0, 6, 0} : (rb_vec3){0, 0, 6};
		open_two(&lab, &force);
		const struct rb_pass pass = pass_of(&lab, 0, 0.5);
		const struct rb_force_impulse out = rb_forces_stated(&pass, &lab.world->state, 1,
		                                                     0);
		const rb_vec3 impulse = frame ? (rb_vec3){-3, 0, 0} : (rb_vec3){0, 0, 3};

		assert_vector(out.impulse, impulse, 1e-15);
		assert_vector(out.turn,
		              rb_vec3_add(rb_vec3_cross((rb_vec3){0, 0.2, 0}, impulse),
		                          (rb_vec3){0, 0, 0.5}),
		              1e-15);
		lab_close(&lab);
	}
}

static void the_bound_holds_for_all_of_them_together(void **state)
{
	struct rb_force_def force = rb_force_def_default();
	struct lab lab;

	(void)state;
	force.vector = (rb_vec3){0, 3, 4};
	force.start_s = 100; /* at any moment */
	open_two(&lab, &force);
	assert_near(rb_forces_bound(lab.world, 0), 10 + 3 / 2.0, 1e-14);
	assert_near(rb_forces_bound(lab.world, 1), 10 + (3 + 5) / 4.0, 1e-14);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gravity_is_an_acceleration_and_gravity_force_a_force),
		cmocka_unit_test(a_force_acts_in_its_time_and_no_longer),
		cmocka_unit_test(a_force_at_a_point_turns_by_its_arm),
		cmocka_unit_test(the_bound_holds_for_all_of_them_together),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
