/* SPDX-License-Identifier: MIT */
/* src/stepped/spring_rows, spring_steps: springs beyond what a step resolves, where joints and contacts hold their bodies. */
#include "worlds.h"

#include "force/spring.h"
#include "math/quat.h"
#include "method/numbers.h"

static const double g = 9.81;
static const rb_vec3 origin = {0, 0, 0};

static void open_stepped(struct lab *lab, double duration, double time_step)
{
	lab_open(lab, duration, 1 / time_step);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = time_step;
	lab->scene.world.gravity = (rb_vec3){0, 0, -g};
}

static int add_hook(struct lab *lab, rb_vec3 at)
{
	struct rb_body_def def = lab_sphere_def(0.01, 1, at, origin);

	def.is_static = true;
	return lab_add(lab, &def);
}

/* `at`: NULL: centres of mass. */
static void add_spring(struct lab *lab, const int end[2], const rb_vec3 *at, double stiffness,
                       double damping)
{
	struct rb_spring_def def = rb_spring_def_default();

	def.a = end[0];
	def.b = end[1];
	def.stiffness = stiffness;
	def.damping = damping;
	if (at) {
		def.at_a = at[0];
		def.at_b = at[1];
	}
	assert_int_equal(rb_scene_add_spring(&lab->scene, &def, &lab->error), RB_OK);
}

/* J: kinetic and potential, with that of springs. */
static double energy(const struct lab *lab)
{
	struct rb_frame_numbers numbers;

	rb_numbers_measure(lab->world, &numbers);
	return numbers.kinetic_energy + numbers.potential_energy;
}

/* The most that energy rises by above that of the start in a run to its end, J. */
static double gain(struct lab *lab)
{
	const double start = energy(lab);
	double most = 0;

	while (rb_world_frame(lab->world) + 1 < rb_world_frame_count(lab->world)) {
		lab_step(lab);
		most = fmax(most, energy(lab) - start);
	}
	return most;
}

static const double link_length = 0.7;

/*
 * Three links of 1, 0.02 and 30 kg on hinges, and springs between two of them and from one to a hook.
 * Looped: the last hinge is a pin, a spring without a length. Returns the last link.
 */
static int lay_chain(struct lab *lab, double k, double damping, bool looped)
{
	static const double mass[3] = {1, 0.02, 30}, angle[3] = {0.3, -1.1, 0.9};
	rb_vec3 at = origin;
	int link[3];

	for (int i = 0; i < 3; i++) {
		const rb_vec3 half = {0.5 * link_length * cos(angle[i]), 0,
		                      -0.5 * link_length * sin(angle[i])};
		const rb_vec3 end = {0.5 * link_length, 0, 0};
		struct rb_body_def def = lab_box_def((rb_vec3){link_length, 0.05, 0.05}, mass[i],
		                                     rb_vec3_add(at, half));
		struct rb_joint_def hinge = rb_joint_def_default();
		int joint;

		def.orientation = rb_quat_from_turn((rb_vec3){0, angle[i], 0});
		def.filters = true;
		link[i] = lab_add(lab, &def);
		hinge.kind = RB_JOINT_HINGE;
		hinge.a = link[i];
		hinge.b = i > 0 ? link[i - 1] : -1;
		hinge.at = at;
		hinge.axis = (rb_vec3){0, 1, 0};
		if (i == 2 && looped)
			add_spring(lab, &link[1], (rb_vec3[2]){end, rb_vec3_neg(end)}, k, 0);
		else
			assert_int_equal(
				rb_scene_add_joint(&lab->scene, &hinge, &joint, &lab->error),
				RB_OK);
		at = rb_vec3_add_scaled(at, 2, half);
	}
	const int hook = add_hook(lab, (rb_vec3){1.5, 0.2, 1});
	if (!looped)
		add_spring(lab, (int[2]){link[0], link[2]}, (rb_vec3[2]){{0.1, 0, 0}, {0, 0, 0.02}},
		           k, damping);
	add_spring(lab, (int[2]){hook, link[1]}, (rb_vec3[2]){{0, 0, 0}, {0.2, 0, 0}}, k, damping);
	return link[2];
}

/*
 * Free, the bodies of these springs would yield by up to 1e5 times as much. Without damping what a
 * step does not resolve is lost; nothing of it may come back as more: m g l of the heavy link is the
 * scale.
 */
static void a_spring_across_joints_gains_nothing_however_stiff(void **state)
{
	(void)state;
	for (int looped = 0; looped <= 1; looped++)
		for (double k = 1e4; k < 2e8; k *= 100)
			for (double h = 0.1; h > 9e-4; h *= 0.1) {
				struct lab lab;

				open_stepped(&lab, h > 2e-3 ? 2 : 0.3, h);
				(void)lay_chain(&lab, k, 0, looped);
				lab_seal(&lab, 1);
				const double most = gain(&lab);
				assert_true(most <= 0.03 * 30 * g * link_length);
				lab_close(&lab);
			}
}

/* Where the last link is after 0.2 s, m. */
static rb_vec3 place_of_chain(enum rb_method_kind method, double h)
{
	struct lab lab;

	open_stepped(&lab, 0.2, h);
	lab.scene.world.method = method;
	const int link = lay_chain(&lab, 1e4, 1e3, false);
	lab_seal(&lab, 1);
	lab_run(&lab);
	const rb_vec3 place = rb_world_position(lab.world, link);
	lab_close(&lab);
	return place;
}

static void a_damped_spring_across_joints_converges_with_the_step(void **state)
{
	(void)state;
	const rb_vec3 wanted = place_of_chain(RB_METHOD_LOCATED, 0.1);
	double off[3];

	for (int k = 0; k < 3; k++)
		off[k] = rb_vec3_length(
			rb_vec3_sub(place_of_chain(RB_METHOD_STEPPED, 4e-3 / (1 << k)), wanted));
	/* of what it is stretched by, m g / k */
	assert_true(off[0] < 3e-3 * 30 * g / 1e4);
	assert_true(off[1] < 0.6 * off[0] && off[2] < 0.6 * off[1]);
}

/*
 * A box of 1 kg that lies on a plane, 0.1 m from where springs want it, and two balls that a spring
 * joins and that fall on it.
 */
static void a_spring_of_what_touches_gains_nothing_however_stiff(void **state)
{
	(void)state;
	for (double k = 1e6; k < 2e8; k *= 100)
		for (double h = 0.03; h > 2e-3; h *= 0.1) {
			struct lab lab;

			open_stepped(&lab, h > 2e-3 ? 1 : 0.1, h);
			lab_surface(&lab, 0.3, 0);
			lab_plane(&lab, origin, (rb_vec3){0, 0, 1});
			const int box = lab_box(&lab, (rb_vec3){0.5, 0.5, 0.5}, 1,
			                        (rb_vec3){0, 0, 0.25}, (rb_quat){1, 0, 0, 0});
			const int hook = add_hook(&lab, (rb_vec3){1, 0.3, -1});
			const int one = lab_sphere(&lab, 0.1, 1, (rb_vec3){2, 0, 0.1}, origin);
			const int two = lab_sphere(&lab, 0.1, 10, (rb_vec3){2, 0, 0.5},
			                           (rb_vec3){0, 0, -3});
			add_spring(&lab, (int[2]){box, hook}, NULL, k, 0);
			add_spring(&lab, (int[2]){one, two}, NULL, k, 0);
			lab_seal(&lab, 1);
			const double start = energy(&lab), most = gain(&lab);
			assert_true(most <= 0.01 * start);
			lab_close(&lab);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_spring_across_joints_gains_nothing_however_stiff),
		cmocka_unit_test(a_damped_spring_across_joints_converges_with_the_step),
		cmocka_unit_test(a_spring_of_what_touches_gains_nothing_however_stiff),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
