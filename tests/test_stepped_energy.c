/* SPDX-License-Identifier: MIT */
/* src/stepped/energy, src/stepped/projection_energy: contact takes energy, and never gives any, in any step. */
#include "solids.h"
#include "worlds.h"

/* What stands in the way of the bodies that a series throws. */
enum ground { FLOOR, SLOPE, BLOCK, CORNER, GROUNDS };
static const double restitutions[] = {0, 0.5, 1}, frictions[] = {0, 0.2, 1, 5};

static double draw(uint64_t series, uint64_t k, double low, double high)
{
	return solids_random(series, 100 + k, low, high);
}

static void lay(struct lab *lab, enum ground ground)
{
	const rb_vec3 origin = {0, 0, 0}, up = {0, 0, 1};

	if (ground == SLOPE) {
		lab_plane(lab, origin, (rb_vec3){sin(0.4), 0, cos(0.4)});
		return;
	}
	lab_plane(lab, origin, up);
	if (ground == CORNER)
		lab_plane(lab, (rb_vec3){-3, 0, 0}, (rb_vec3){0.9, 0.1, 0.3});
	if (ground == BLOCK) {
		struct rb_body_def def = rb_body_def_default();

		def.call = "box";
		def.shape.kind = RB_SHAPE_BOX;
		rb_vec3_to(def.shape.size, (rb_vec3){3, 2, 1});
		def.position = (rb_vec3){0.3, 0.2, 0.5};
		def.is_static = true;
		(void)lab_add(lab, &def);
	}
}

static void throw(struct lab * lab, uint64_t series, int number)
{
	const uint64_t of = 8 * series + (uint64_t)number;
	struct rb_body_def def = rb_body_def_default();
	static const enum rb_shape_kind kinds[] = {RB_SHAPE_BOX, RB_SHAPE_CAPSULE,
	                                           RB_SHAPE_CYLINDER, RB_SHAPE_SPHERE};

	def.call = "body";
	def.shape.kind = kinds[(series + (uint64_t)number) % 4];
	def.shape.radius = draw(of, 0, 0.1, 0.4);
	for (int k = 0; k < 3; k++)
		def.shape.size[k] = draw(of, 1 + (uint64_t)k, 0.1, 1);
	if (def.shape.kind == RB_SHAPE_CAPSULE || def.shape.kind == RB_SHAPE_CYLINDER)
		def.shape.size[2] = draw(of, 4, 0.1, 1);
	def.mass = draw(of, 5, 0.2, 5);
	def.position = (rb_vec3){draw(of, 6, -0.3, 0.3), draw(of, 7, -0.3, 0.3), 2.5 + 2 * number};
	def.orientation = solids_turn(of);
	def.velocity = (rb_vec3){draw(of, 8, -3, 3), draw(of, 9, -3, 3), draw(of, 10, -5, 0)};
	def.angular_velocity = (rb_vec3){draw(of, 11, -15, 15), draw(of, 12, -15, 15),
	                                 draw(of, 13, -15, 15)};
	(void)lab_add(lab, &def);
}

static void make(struct lab *lab, uint64_t series, double time_step, double gravity)
{
	lab_open(lab, 2, 1 / time_step);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = time_step;
	lab->scene.world.gravity = (rb_vec3){0, 0, -gravity};
	lab_surface(lab, frictions[series % 4], restitutions[series % 3]);
	lay(lab, (enum ground)(series / 2 % GROUNDS));
	for (int k = 0; k < 1 + (int)(series % 3); k++)
		throw(lab, series, k);
	lab_seal(lab, 1);
}

static double total(struct lab *lab)
{
	const struct rb_frame_numbers numbers = rb_world_totals(lab->world);

	return numbers.kinetic_energy + numbers.potential_energy;
}

/* The largest rise of a step, over the energy that there is to begin with. */
static double rise(struct lab *lab)
{
	const double scale = fabs(total(lab));
	double least = total(lab), most = 0;

	while (rb_world_frame(lab->world) + 1 < rb_world_frame_count(lab->world)) {
		lab_step(lab);
		most = fmax(most, total(lab) - least);
		least = fmin(least, total(lab));
	}
	return most / scale;
}

/*
 * A step may gain what sums over its groups round away, sixteen units in the last place; a few hundred steps, each of which
 * gains as much, stay far below the bound.
 */
static void nothing_that_is_thrown_gains_energy(void **state)
{
	static const double steps[] = {1.0 / 30, 1.0 / 120, 1.0 / 480};

	/* a rebound is paid for only by what stays in contact, not by those that fly beside it */
	static const uint64_t others[] = {1910, 440};
	const uint64_t count = 72 + sizeof others / sizeof *others;

	(void)state;
	for (uint64_t k = 0; k < count; k++) {
		const uint64_t series = k < 72 ? k : others[k - 72];
		struct lab lab;

		make(&lab, series, steps[series % 5 % 3], series % 7 == 0 ? 0 : 9.81);
		const double found = rise(&lab);
		if (!(found <= 1e-12))
			fail_msg("series %d: energy rises by %.3g of what there was", (int)series,
			         found);
		lab_close(&lab);
	}
}

/* Elastic, with friction, for some hundred impacts on corners and edges. */
static void a_box_that_rattles_between_walls_keeps_to_its_energy(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 10, 60);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 1.0 / 60;
	lab_surface(&lab, 0.3, 1);
	for (int k = 0; k < 6; k++) {
		const double sign = k % 2 ? 1 : -1;
		const rb_vec3 out = {(k / 2 == 0) * sign, (k / 2 == 1) * sign, (k / 2 == 2) * sign};

		lab_plane(&lab, rb_vec3_scale(-1, out), out);
	}
	struct rb_body_def def = rb_body_def_default();
	def.call = "box";
	def.shape.kind = RB_SHAPE_BOX;
	rb_vec3_to(def.shape.size, (rb_vec3){0.6, 0.4, 0.3});
	def.mass = 1;
	def.velocity = (rb_vec3){3, 4, 5};
	def.angular_velocity = (rb_vec3){10, -7, 4};
	(void)lab_add(&lab, &def);
	lab_seal(&lab, 1);
	assert_true(rise(&lab) <= 1e-12);
	assert_true(rb_world_totals(lab.world).kinetic_energy > 0);
	lab_close(&lab);
}

/* Without friction it loses nothing either, in 1e4 steps. */
static void what_slides_freely_keeps_its_energy(void **state)
{
	struct lab lab;

	(void)state;
	lab_open(&lab, 10, 10);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 1e-3;
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(&lab, 0, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	(void)lab_sphere(&lab, 0.1, 1, (rb_vec3){0, 0, 0.1}, (rb_vec3){2, 1, 0});
	lab_seal(&lab, 1);
	const double before = total(&lab);
	lab_run(&lab);
	assert_near(total(&lab), before, 1e-10 * before);
	lab_close(&lab);
}

/* ---- ropes without give ---- */

static void hang(struct lab *lab, enum rb_joint_kind kind, int a, int b)
{
	struct rb_joint_def def = rb_joint_def_default();

	def.kind = (int)kind;
	def.a = a;
	def.b = b;
	if (kind == RB_JOINT_SLIDER)
		def.axis = (rb_vec3){0, 1, 0};
	assert_int_equal(rb_scene_add_joint(&lab->scene, &def, NULL, &lab->error), RB_OK);
}

/*
 * Two on parallel slides, a rope of the least distance across them: it pulls at right angles to
 * what moves, and lets nothing move but both together. `ball`, kg: what hits the first one, where
 * with friction the step is cut and its last part is short.
 */
static void slide(struct lab *lab, double step, double mass, double ball, double friction)
{
	const rb_vec3 size = {0.2, 0.2, 0.2};
	const double v = ball > 0 ? 0 : -1.2;
	int of[2];

	lab_open(lab, 1, 100);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = step;
	lab->scene.world.gravity = (rb_vec3){0, 0, 0};
	lab_surface(lab, friction, 0);
	struct rb_body_def def = lab_box_def(size, 1, (rb_vec3){0, 0, 0});
	of[0] = lab_add(lab, &def);
	def = lab_box_def(size, mass, (rb_vec3){1, 0, 0});
	def.velocity.y = v;
	of[1] = lab_add(lab, &def);
	hang(lab, RB_JOINT_SLIDER, of[0], -1);
	hang(lab, RB_JOINT_SLIDER, of[1], -1);
	hang(lab, RB_JOINT_ROPE, of[0], of[1]);
	if (ball > 0)
		(void)lab_sphere(lab, 0.1, ball, (rb_vec3){0, -1, 0}, (rb_vec3){0, 3, 0});
	lab_seal(lab, 1);
}

static double along_slides(struct lab *lab)
{
	double sum = 0;

	for (int i = 0; i < lab->model->body_count; i++)
		sum += rb_world_velocity(lab->world, i).y / lab->model->inverse_mass[i];
	return sum;
}

static double mass_of(const struct lab *lab)
{
	double sum = 0;

	for (int i = 0; i < lab->model->body_count; i++)
		sum += 1 / lab->model->inverse_mass[i];
	return sum;
}

static void a_rope_across_slides_stops_what_it_holds(void **state)
{
	static const double steps[] = {0.1, 0.01, 0.001}, masses[] = {0.05, 0.7, 1, 20};
	static const double balls[] = {0, 0.2, 1, 5};

	(void)state;
	for (int k = 0; k < 3 * 4 * 4; k++) {
		struct lab lab;

		slide(&lab, steps[k % 3], masses[k / 3 % 4], balls[k / 12], k % 2 * 0.3);
		const double start = total(&lab), p = along_slides(&lab);
		const double end = 0.5 * p * p / mass_of(&lab);

		while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
			lab_step(&lab);
			assert_true(total(&lab) <= (1 + 1e-9) * start);
		}
		/* which it sees once it is longer by the tolerance, where it has begun to turn */
		assert_near(total(&lab), end, 0.1 * start);
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_that_is_thrown_gains_energy),
		cmocka_unit_test(a_box_that_rattles_between_walls_keeps_to_its_energy),
		cmocka_unit_test(what_slides_freely_keeps_its_energy),
		cmocka_unit_test(a_rope_across_slides_stops_what_it_holds),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
