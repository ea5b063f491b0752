/* SPDX-License-Identifier: MIT */
/* src/stepped/spring_rows, spring_steps: springs beyond what a step resolves, where joints and contacts hold their bodies. */
#include "worlds.h"

#include "force/spring.h"
#include "math/random.h"
#include "math/quat.h"
#include "method/numbers.h"
#include "stepped/net_solve.h"

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
 * A small box on a slider, and one as a bob of a hinge with the same arm, each on a spring far from
 * its centre, which the step resolves as joints let it yield; the slider's way is told.
 */
static double swings(double stiffness, double rest, double h, double *off)
{
	const rb_vec3 side = {0, 0, 0.3}, edge = {0.1, 0.1, 0.1};
	struct lab lab;
	int joint;

	open_stepped(&lab, 1, h);
	lab.scene.world.gravity = origin;
	const int slide = lab_box(&lab, edge, 2, origin, rb_quat_identity);
	const int bob = lab_box(&lab, edge, 2, (rb_vec3){1, 5, 0}, rb_quat_identity);
	const int hook[2] = {add_hook(&lab, (rb_vec3){-1, 0, 0.3}),
	                     add_hook(&lab, (rb_vec3){1, 5, 1})};
	struct rb_joint_def def = rb_joint_def_default();

	def.kind = RB_JOINT_SLIDER;
	def.a = slide;
	def.axis = (rb_vec3){1, 0, 0};
	assert_int_equal(rb_scene_add_joint(&lab.scene, &def, &joint, &lab.error), RB_OK);
	def.kind = RB_JOINT_HINGE;
	def.a = bob;
	def.at = (rb_vec3){0, 5, 0};
	def.axis = (rb_vec3){0, 1, 0};
	assert_int_equal(rb_scene_add_joint(&lab.scene, &def, &joint, &lab.error), RB_OK);
	for (int k = 0; k < 2; k++) {
		struct rb_spring_def spring = rb_spring_def_default();

		spring.a = hook[k];
		spring.b = k == 0 ? slide : bob;
		spring.at_b = side;
		spring.stiffness = stiffness;
		spring.rest_length_m = rest;
		assert_int_equal(rb_scene_add_spring(&lab.scene, &spring, &lab.error), RB_OK);
	}
	lab_seal(&lab, 1);
	const double start = energy(&lab);
	*off = 0;
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		lab_step(&lab);
		*off = fmax(*off, fabs(energy(&lab) - start) / start);
	}
	const double way = rb_world_position(lab.world, slide).x;
	lab_close(&lab);
	return way;
}

/* Of second order, with a length and without. */
static void what_joints_let_a_step_resolve_swings(void **state)
{
	(void)state;
	for (int k = 0; k < 2; k++) {
		const double stiffness = 2000, rest = k == 0 ? 1.1 : 0, w = sqrt(stiffness / 2);
		const double size = k == 0 ? 0.1 : -1, wanted = size * (1 - cos(w));
		double off[2], energies[2];

		for (int n = 0; n < 2; n++)
			off[n] = fabs(swings(stiffness, rest, 1.0 / (480 << n), &energies[n]) -
			              wanted);
		print_message("off by %g, %g m; energy %g, %g\n", off[0], off[1], energies[0],
		              energies[1]);
		assert_true(off[1] < 0.3 * off[0] && energies[1] < 1e-4);
		/* steps of the mean are late by w t (w h)^2 / 12 of phase */
		assert_true(off[0] < 1.1 * fabs(size) * w * (w / 480) * (w / 480) / 12);
	}
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

/* ---- nets ---- */

/* A number of a random net: of its own for each use. */
struct dice {
	uint64_t seed, count;
};

static double throw_between(struct dice *dice, double low, double high)
{
	return low + (high - low) * rb_random_unit(dice->seed, 0, dice->count++);
}

static double throw_decades(struct dice *dice, double low, double high)
{
	return exp(throw_between(dice, log(low), log(high)));
}

static int throw_number(struct dice *dice, int low, int high)
{
	return low + (int)(throw_between(dice, 0, 1) * (high - low + 1));
}

static rb_vec3 throw_vector(struct dice *dice, double size)
{
	rb_vec3 v;

	v.x = throw_between(dice, -size, size);
	v.y = throw_between(dice, -size, size);
	v.z = throw_between(dice, -size, size);
	return v;
}

struct web {
	int id[41];
	rb_vec3 at[41], arm[41];
	double mass[41];
	int count; /* of bodies; a hook follows */
	bool is_free;
};

static void throw_spring(struct lab *lab, struct dice *dice, const struct web *web, int a, int b,
                         double stiffness)
{
	const rb_vec3 between = rb_vec3_sub(web->at[b], web->at[a]);
	struct rb_spring_def def = rb_spring_def_default();
	const double mass = fmin(web->mass[a], web->mass[b]);

	def.a = web->id[a];
	def.b = web->id[b];
	def.stiffness = stiffness;
	def.damping = throw_number(dice, 0, 1) * throw_between(dice, 0, 1) * sqrt(stiffness * mass);
	if (throw_number(dice, 0, 1))
		def.rest_length_m = throw_between(dice, 0, 2) * rb_vec3_length(between);
	if (rb_vec3_max_abs(web->arm[a]) > 0)
		def.at_a = web->arm[a];
	if (rb_vec3_max_abs(web->arm[b]) > 0)
		def.at_b = web->arm[b];
	assert_int_equal(rb_scene_add_spring(&lab->scene, &def, &lab->error), RB_OK);
}

/*
 * 3 to 40 bodies of 1e-3 to 1e3 kg, chained, closed or crossed by springs of which a step of h_s
 * does not resolve the first, and that others are up to a million times softer than.
 */
static void throw_net(struct lab *lab, struct dice *dice, double h, struct web *web)
{
	const double spread = (double[3]){1, 30, 1000}[throw_number(dice, 0, 2)];
	const double off = throw_number(dice, 0, 1) * 0.2, speed = throw_number(dice, 0, 1) * 3;
	const double softest = throw_decades(dice, 1e-6, 1);

	*web = (struct web){.count = throw_number(dice, 3, throw_number(dice, 3, 40)),
	                    .is_free = throw_number(dice, 0, 2) > 0};
	for (int k = 0; k < web->count; k++) {
		const rb_vec3 size = {0.3, 0.4, 0.2};
		struct rb_body_def def;

		web->at[k] = rb_vec3_add((rb_vec3){0.5 * k, 0, 0}, throw_vector(dice, 1));
		web->mass[k] = throw_decades(dice, 1 / spread, spread);
		web->arm[k] = throw_vector(dice, off);
		def = throw_number(dice, 0, 1)
		              ? lab_box_def(size, web->mass[k], web->at[k])
		              : lab_sphere_def(0.2, web->mass[k], web->at[k], origin);
		def.velocity = throw_vector(dice, speed);
		def.filters = true;
		web->id[k] = lab_add(lab, &def);
	}
	web->id[web->count] = add_hook(lab, (rb_vec3){0, 0, 3});
	web->at[web->count] = (rb_vec3){0, 0, 3};
	web->mass[web->count] = 1;
	const double stiffest = throw_decades(dice, 4, 1e6) * web->mass[0] / (h * h);
	for (int k = 1; k < web->count; k++)
		throw_spring(lab, dice, web, k, k - 1,
		             k == 1 ? stiffest : stiffest * throw_decades(dice, softest, 1));
	for (int k = throw_number(dice, 0, web->count); k > 0; k--) {
		const int a = throw_number(dice, 0, web->count - 1);

		throw_spring(lab, dice, web, a, (a + throw_number(dice, 1, 2)) % web->count,
		             stiffest * throw_decades(dice, softest, 1));
	}
	if (!web->is_free)
		throw_spring(lab, dice, web, throw_number(dice, 0, web->count - 1), web->count,
		             stiffest * throw_decades(dice, softest, 1));
}

/* kg m/s of all; and the sum of sizes, to which rounding is compared. */
static rb_vec3 momentum_of(const struct lab *lab, const struct web *web, double *size)
{
	rb_vec3 sum = {0, 0, 0};

	for (int k = 0; k < web->count; k++) {
		const rb_vec3 p = rb_vec3_scale(web->mass[k],
		                                rb_world_velocity(lab->world, web->id[k]));

		sum = rb_vec3_add(sum, p);
		*size = fmax(*size, rb_vec3_length(p));
	}
	return sum;
}

enum { NETS = 3 };

static void run_net(uint64_t seed, double h)
{
	enum { STEPS = 12 };
	struct dice dice = {.seed = seed};
	struct lab lab;
	struct web web;
	double size = 0, scale = 0;

	open_stepped(&lab, STEPS * h, h);
	const bool weighs = throw_number(&dice, 0, 1);
	if (!weighs)
		lab.scene.world.gravity = origin;
	throw_net(&lab, &dice, h, &web);
	lab_seal(&lab, 1);
	const double start = energy(&lab);
	const rb_vec3 momentum = momentum_of(&lab, &web, &size);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
		struct rb_frame_numbers numbers;

		lab_step(&lab);
		rb_numbers_measure(lab.world, &numbers);
		scale = fmax(scale,
		             fabs(start) + numbers.kinetic_energy + fabs(numbers.potential_energy));
		/* rounding of stretches, k l^2 eps, is far below what equations are solved to */
		if (energy(&lab) > start + 1e-9 * scale)
			fail_msg("seed %d, step %g s: %g J gained of %g", (int)seed, h,
			         energy(&lab) - start, scale);
		if (web.is_free && !weighs) {
			const rb_vec3 off = rb_vec3_sub(momentum_of(&lab, &web, &size), momentum);

			assert_true(rb_vec3_length(off) <= 1e-12 * STEPS * web.count * size);
		}
	}
	lab_close(&lab);
}

static void a_net_of_stiff_springs_never_gains(void **state)
{
	(void)state;
	for (double h = 0.1; h > 9e-5; h *= 0.1)
		for (uint64_t seed = 1; seed <= NETS; seed++)
			run_net(seed, h);
}

/* Balls that part along their springs, and fall: a tenth of each speed is left to drag in a step. */
static void a_net_that_drag_slows_down_gains_nothing(void **state)
{
	const double h = 0.01;
	const struct rb_drag_def drag = {.linear = 0.1 / h};
	struct lab lab;
	int ball[3];

	(void)state;
	open_stepped(&lab, 20 * h, h);
	assert_int_equal(rb_scene_add_drag(&lab.scene, &drag, &lab.error), RB_OK);
	for (int k = 0; k < 3; k++) {
		ball[k] = lab_sphere(&lab, 0.1, 1, (rb_vec3){k, 0.2 * k * k, 0},
		                     (rb_vec3){k - 1, 0, 0.5 * k});
		if (k > 0)
			add_spring(&lab, &ball[k - 1], NULL, 1e8, 0);
	}
	lab_seal(&lab, 1);
	const double start = energy(&lab);
	assert_true(gain(&lab) <= 1e-9 * start);
	lab_close(&lab);
}

/* A chain from a hook, rolled up so that springs turn a good deal: what is learnt saves factors. */
static void a_chain_takes_few_factors(void **state)
{
	enum { LINKS = 12 };
	static struct rb_net_body body[LINKS];
	static struct rb_net_spring spring[LINKS];
	struct rb_net net = {
		.body = body, .spring = spring, .body_count = LINKS, .spring_count = LINKS};
	struct rb_arena arena = {0};
	const double h = 0.03;

	(void)state;
	for (int k = 0; k < LINKS; k++) {
		const rb_vec3 way = {0.5 * cos(k), 0.5 * sin(k), 0.1};

		body[k] = (struct rb_net_body){.index = k,
		                               .mass = 1 + k % 3,
		                               .scalar = 1,
		                               .linear = {5 * sin(2 * k), 5 * cos(3 * k), k % 2},
		                               .constant = {0, 0, -g * h}};
		spring[k] = (struct rb_net_spring){.body = {k - 1, k},
		                                   .number = k,
		                                   .stiffness = 1e4,
		                                   .rest = 0.5,
		                                   .from = way,
		                                   .length = rb_vec3_length(way)};
	}
	assert_true(rb_net_solve(&net, h, &arena));
	rb_arena_release(&arena);
	assert_true(net.factors <= 4 && net.solves <= 40);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_spring_across_joints_gains_nothing_however_stiff),
		cmocka_unit_test(a_damped_spring_across_joints_converges_with_the_step),
		cmocka_unit_test(what_joints_let_a_step_resolve_swings),
		cmocka_unit_test(a_spring_of_what_touches_gains_nothing_however_stiff),
		cmocka_unit_test(a_net_of_stiff_springs_never_gains),
		cmocka_unit_test(a_net_that_drag_slows_down_gains_nothing),
		cmocka_unit_test(a_chain_takes_few_factors),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
