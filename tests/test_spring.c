/* SPDX-License-Identifier: MIT */
/* src/force/spring.c */
#include "worlds.h"

#include "force/spring.h"

/* Two balls, the second one first among indices or not, with poses by hand. */
struct pair {
	struct lab lab;
	struct rb_pose pose[2];
	struct rb_element_query query;
};

static struct rb_pose pose_of(const struct rb_element_query *query, int index)
{
	return ((const struct pair *)query->user)->pose[index];
}

static void open_pair(struct pair *pair)
{
	const struct rb_world_options options = {.threads = 1};

	lab_open(&pair->lab, 1, 10);
	lab_sphere(&pair->lab, 0.1, 2, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	lab_sphere(&pair->lab, 0.1, 3, (rb_vec3){2, 0, 0}, (rb_vec3){0, 0, 0});
	lab_seal_with(&pair->lab, &options, NULL);
	for (int i = 0; i < 2; i++)
		pair->pose[i] = (struct rb_pose){.orientation = rb_quat_identity};
	pair->query = (struct rb_element_query){
		.model = pair->lab.model, .pose = pose_of, .user = pair};
}

/* Poses, velocities and ends that have nothing in particular. */
static struct rb_spring_def some(struct pair *pair, int k)
{
	for (int i = 0; i < 2; i++)
		pair->pose[i] = (struct rb_pose){
			.position = {sin(k + i), 2 * i + cos(3 * k), sin(5 * k + i)},
			.orientation = rb_quat_from_turn((rb_vec3){k, 0.3 * i, 1}),
			.velocity = {cos(k), sin(2 * k + i), i},
			.spin = {i + 1, cos(k), sin(k)}};
	return (struct rb_spring_def){.a = k % 2,
	                              .b = 1 - k % 2,
	                              .at_a = {0.3, 0.1 * sin(k), 0},
	                              .at_b = {0, -0.2, 0.4},
	                              .stiffness = 7,
	                              .damping = 0.5,
	                              .rest_length_m = 0.6};
}

/* Where body `i`'s end is, and moves to. */
static rb_vec3 end_of(const struct pair *pair, int i, rb_vec3 at, rb_vec3 *velocity)
{
	const rb_vec3 arm = rb_quat_rotate(pair->pose[i].orientation, at);

	*velocity = rb_vec3_add(pair->pose[i].velocity, rb_vec3_cross(pair->pose[i].spin, arm));
	return rb_vec3_add(pair->pose[i].position, arm);
}

static void tension_is_stiffness_and_damping_along_its_line(void **state)
{
	struct pair pair;

	(void)state;
	open_pair(&pair);
	for (int k = 0; k < 40; k++) {
		const struct rb_spring_def spring = some(&pair, k);
		struct rb_wrench on[2];
		rb_vec3 va, vb;
		const rb_vec3 a = end_of(&pair, spring.a, spring.at_a, &va);
		const rb_vec3 b = end_of(&pair, spring.b, spring.at_b, &vb);
		const rb_vec3 d = rb_vec3_sub(b, a);
		const double length = rb_vec3_length(d);
		const double rate = rb_vec3_dot(rb_vec3_sub(vb, va), d) / length;
		const rb_vec3 pull = rb_vec3_scale((7 * (length - 0.6) + 0.5 * rate) / length, d);

		for (int i = 0; i < 2; i++)
			assert_true(rb_force_spring.act(&pair.query, &spring, i, &pair.pose[i],
			                                &on[i]));
		assert_vector(on[spring.a].force, pull, 1e-12);
		assert_vector(on[spring.b].force, rb_vec3_neg(pull), 1e-12);
		/* it turns nothing as a whole: torques about the origin cancel */
		const rb_vec3 whole = rb_vec3_add(
			rb_vec3_add(on[0].torque,
		                    rb_vec3_cross(pair.pose[0].position, on[0].force)),
			rb_vec3_add(on[1].torque,
		                    rb_vec3_cross(pair.pose[1].position, on[1].force)));
		assert_vector(whole, ((rb_vec3){0, 0, 0}), 1e-12);
		/* what its damper takes */
		assert_near(rb_force_spring.dissipation(&pair.query, &spring), 0.5 * rate * rate,
		            1e-12);
		assert_near(rb_force_spring.energy(&pair.query, &spring),
		            3.5 * (length - 0.6) * (length - 0.6), 1e-12);
	}
	lab_close(&pair.lab);
}

/* -dE/dx by differences; of the second order, so that the step's square and rounding over the step are left. */
static void the_force_is_the_slope_of_its_energy(void **state)
{
	struct pair pair;

	(void)state;
	open_pair(&pair);
	for (int k = 0; k < 20; k++) {
		struct rb_spring_def spring = some(&pair, k);
		struct rb_wrench out;
		const double h = 1e-5;
		double energy[2];

		spring.damping = 0;
		assert_true(rb_force_spring.act(&pair.query, &spring, 0, &pair.pose[0], &out));
		const double x = pair.pose[0].position.x;
		for (int side = 0; side < 2; side++) {
			pair.pose[0].position.x = x + (side ? h : -h);
			energy[side] = rb_force_spring.energy(&pair.query, &spring);
		}
		assert_near(out.force.x, -(energy[1] - energy[0]) / (2 * h), 1e-8);
	}
	lab_close(&pair.lab);
}

static void ends_at_one_point_have_no_direction_and_no_force(void **state)
{
	const struct rb_spring_def spring = {.a = 0,
	                                     .b = 1,
	                                     .at_a = {(double)NAN, 0, 0},
	                                     .at_b = {(double)NAN, 0, 0},
	                                     .stiffness = 7,
	                                     .rest_length_m = 0};
	struct pair pair;
	struct rb_wrench out;

	(void)state;
	open_pair(&pair);
	assert_false(rb_force_spring.act(&pair.query, &spring, 0, &pair.pose[0], &out));
	assert_near(rb_force_spring.energy(&pair.query, &spring), 0, 0);
	lab_close(&pair.lab);
}

static void its_rest_length_is_that_at_the_start_where_none_is_given(void **state)
{
	struct rb_spring_def spring = rb_spring_def_default();
	struct pair pair;

	(void)state;
	open_pair(&pair);
	spring.a = 0;
	spring.b = 1;
	spring.at_b = (rb_vec3){1, 4, 0}; /* at 3, 4, 0 */
	rb_force_spring.seal(&pair.lab.scene, &spring);
	assert_near(spring.rest_length_m, 5, 1e-15);
	spring.rest_length_m = 0.5;
	rb_force_spring.seal(&pair.lab.scene, &spring);
	assert_near(spring.rest_length_m, 0.5, 0);
	/* it can turn the body that it is fixed to off its centre */
	assert_true(rb_force_spring.turns(&pair.lab.scene, &spring, 1));
	assert_false(rb_force_spring.turns(&pair.lab.scene, &spring, 0));
	lab_close(&pair.lab);
}

static void numbers_that_make_no_sense_are_faults(void **state)
{
	struct rb_spring_def good = rb_spring_def_default();
	char text[RB_ELEMENT_FAULT_SIZE];
	struct pair pair;

	(void)state;
	open_pair(&pair);
	good.a = 0;
	good.b = 1;
	good.stiffness = 1;
	assert_false(rb_force_spring.fault(&pair.lab.scene, &good, text));
	for (int k = 0; k < 6; k++) {
		struct rb_spring_def wrong = good;
		double *const number[] = {&wrong.stiffness, &wrong.damping, &wrong.rest_length_m};

		*number[k % 3] = k < 3 ? -1 : (double)INFINITY;
		assert_true(rb_force_spring.fault(&pair.lab.scene, &wrong, text));
	}
	good.at_b = (rb_vec3){-2, 0, 0}; /* where the other end is */
	assert_false(rb_force_spring.fault(&pair.lab.scene, &good, text));
	good.rest_length_m = 1;
	assert_true(rb_force_spring.fault(&pair.lab.scene, &good, text));
	assert_non_null(strstr(text, "no direction"));
	lab_close(&pair.lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tension_is_stiffness_and_damping_along_its_line),
		cmocka_unit_test(the_force_is_the_slope_of_its_energy),
		cmocka_unit_test(ends_at_one_point_have_no_direction_and_no_force),
		cmocka_unit_test(its_rest_length_is_that_at_the_start_where_none_is_given),
		cmocka_unit_test(numbers_that_make_no_sense_are_faults),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
