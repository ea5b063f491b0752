/* SPDX-License-Identifier: MIT */
/* src/stepped/reduced_islands: what joints alone hold moves in steps as it is located, to a high order. */
#include "jointed.h"

#include "method/numbers.h"
#include "stepped/stepped_state.h"

enum { BODIES = 5, WORLD = -1 };

/* What hangs on what: a chain, and a branch that is joined the other way round. */
static const int parent[BODIES] = {WORLD, 0, 1, 1, 3};

static const int all_kinds[] = {RB_JOINT_FIXED,  RB_JOINT_BALL,        RB_JOINT_HINGE,
                                RB_JOINT_SLIDER, RB_JOINT_CYLINDRICAL, RB_JOINT_UNIVERSAL};
enum { KINDS = sizeof all_kinds / sizeof all_kinds[0] };

static void add_joint(struct lab *lab, int kind, int k)
{
	const struct rb_body_def *const body = lab->scene.bodies;
	const int other = parent[k];
	const bool back = k >= 3;
	struct rb_joint_def def = jointed_def(kind, back ? other : k, back ? k : other);

	def.at = rb_vec3_add(body[k].position, (rb_vec3){-0.5, 0.1, 0.2});
	def.axis = (rb_vec3){0.3, 1, -0.2 * k};
	if (kind == RB_JOINT_UNIVERSAL)
		def.axis_b = (rb_vec3){1, -0.3, 0};
	jointed_add(lab, def);
}

/*
 * Bodies with that kind of joint, of which the first hangs on the world (held), or all turn; in a
 * medium, or not, that slows them down.
 */
static void open_tree(struct lab *lab, enum rb_method_kind method, double h, int kind, bool held,
                      double drags)
{
	const rb_vec3 spin = {1, -2, 0.5};
	const struct rb_drag_def drag = {.linear = 0.3 * drags, .quadratic = 0.8 * drags};

	lab_open(lab, 0.5, 8);
	lab->scene.world.method = method;
	lab->scene.world.time_step_s = h;
	lab->scene.world.gravity = (rb_vec3){0, 3, -9.81};
	lab->scene.record.ledger = lab->scene.record.ledger_given = true;
	if (drags > 0)
		assert_int_equal(rb_scene_add_drag(&lab->scene, &drag, &lab->error), RB_OK);
	for (int k = 0; k < BODIES; k++) {
		struct rb_body_def def = lab_box_def((rb_vec3){0.8, 0.2 + 0.1 * k, 0.4},
		                                     1 + 0.5 * k, (rb_vec3){k, k == 3 ? -1 : 0, 0});

		def.filters = true;
		if (!held) {
			def.angular_velocity = spin;
			def.velocity = rb_vec3_cross(spin, def.position);
		}
		lab_add(lab, &def);
	}
	for (int k = held ? 0 : 1; k < BODIES; k++)
		add_joint(lab, kind, k);
	lab_seal(lab, 1);
}

/* Energy and momenta that the ledger does not explain, with those that the world began with. */
static void measure(const struct lab *lab, double *energy, rb_vec3 momentum[2])
{
	struct rb_frame_numbers numbers;

	rb_numbers_measure(lab->world, &numbers);
	const struct rb_ledger_values v = rb_ledger_values(&lab->world->ledger, &numbers);
	*energy = v.energy[RB_ENERGY_CAUSES];
	momentum[0] = v.momentum[RB_MOMENTUM_CAUSES][0];
	momentum[1] = v.momentum[RB_MOMENTUM_CAUSES][1];
}

static void each_kind_of_joint_moves_in_steps_as_it_is_located(void **state)
{
	(void)state;
	for (int n = 0; n < 4 * KINDS; n++) {
		const int kind = all_kinds[n / 4];
		const bool held = n % 2, drags = n / 2 % 2;
		rb_vec3 place[2][BODIES], speed[2][BODIES];
		double off = 0;

		if (held && kind == RB_JOINT_FIXED)
			continue; /* it stands still */
		for (int m = 0; m < 2; m++) {
			double energy[2] = {0, 0};
			rb_vec3 momentum[2][2];
			struct lab lab;

			open_tree(&lab, m ? RB_METHOD_STEPPED : RB_METHOD_LOCATED, 1.0 / 400, kind,
			          held, drags);
			lab_step(&lab);
			measure(&lab, &energy[0], momentum[0]);
			while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world))
				lab_step(&lab);
			for (int k = 0; k < BODIES; k++) {
				place[m][k] = rb_world_position(lab.world, k);
				speed[m][k] = rb_world_velocity(lab.world, k);
			}
			for (int k = 0; m && k < lab.scene.joint_count; k++)
				assert_true(lab.world->stepped->solver.joint[k].reduced);
			measure(&lab, &energy[1], momentum[1]);
			/* of what is located, momentum and what drag takes are entered as arcs end */
			if (m || !drags)
				assert_near(energy[1], energy[0], 1e-8);
			for (int r = 0; m && r < 2; r++)
				assert_vector(momentum[1][r], momentum[0][r], 1e-9);
			lab_close(&lab);
		}
		for (int k = 0; k < BODIES; k++)
			off = fmax(off,
			           rb_vec3_length(rb_vec3_sub(place[1][k], place[0][k])) +
			                   rb_vec3_length(rb_vec3_sub(speed[1][k], speed[0][k])));
		print_message("kind %d, held %d, drag %d: %g\n", kind, held, drags, off);
		/* order 6: (h w)^6 over 1e5 with w below 20/s, and rounding */
		assert_true(off < 1e-8);
	}
}

/* Where the last body of a tree is, and the energy that the ledger misses. */
static rb_vec3 end_of(double h, double *left)
{
	double begin, end;
	rb_vec3 momentum[2];
	struct lab lab;

	open_tree(&lab, RB_METHOD_STEPPED, h, RB_JOINT_HINGE, true, 0);
	measure(&lab, &begin, momentum);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world))
		lab_step(&lab);
	measure(&lab, &end, momentum);
	*left = fabs(end - begin);
	const rb_vec3 at = rb_world_position(lab.world, BODIES - 1);
	lab_close(&lab);
	return at;
}

static void swinging_is_of_order_six(void **state)
{
	double left[4], change[3];
	rb_vec3 at[4];

	(void)state;
	for (int n = 0; n < 4; n++)
		at[n] = end_of(1.0 / (16 << n), &left[n]);
	for (int n = 0; n < 3; n++)
		change[n] = rb_vec3_length(rb_vec3_sub(at[n + 1], at[n]));
	print_message("%g %g %g; energy %g %g %g %g J\n", change[0], change[1], change[2], left[0],
	              left[1], left[2], left[3]);
	/* 64, but for higher orders of the coarser step */
	assert_true(change[1] / change[2] > 40 && change[1] / change[2] < 90);
	assert_true(left[3] < left[2] / 30);
}

/*
 * A light body between the world and one of a million times its mass: as the joints come into line
 * it whips round by radians in a step of 10 ms, in sixteen parts of which it is resolved but at the
 * turn itself.
 */
static void a_light_link_that_whips_round_is_followed_in_parts(void **state)
{
	double energy[2];
	rb_vec3 momentum[2];
	struct lab lab;

	(void)state;
	lab_open(&lab, 5, 100);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab.scene.record.ledger = lab.scene.record.ledger_given = true;
	for (int k = 0; k < 2; k++) {
		struct rb_joint_def def = jointed_def(RB_JOINT_BALL, k, k - 1);

		(void)lab_sphere(&lab, k ? 0.01 : 0.1, k ? 1e6 : 1, (rb_vec3){2 + 2 * k, 0, 0},
		                 (rb_vec3){0, 0, 0});
		def.at = (rb_vec3){2 * k, 0, 0};
		jointed_add(&lab, def);
	}
	lab.scene.world.time_step_s = 0.01;
	lab_seal(&lab, 1);
	lab_step(&lab);
	measure(&lab, &energy[0], momentum);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world))
		lab_step(&lab);
	measure(&lab, &energy[1], momentum);
	/* of 8e7 J that it falls by: 0.1 with four parts */
	print_message("%g J\n", energy[1] - energy[0]);
	assert_near(energy[1], energy[0], 0.01 * 8e7);
	lab_close(&lab);
}

/* A pendulum that swings to and fro: what energy is off by neither grows nor shrinks. */
static void energy_does_not_drift(void **state)
{
	double worst[2] = {0, 0}, begin = 0;
	struct lab lab;

	(void)state;
	lab_open(&lab, 60, 20);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 0.05;
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	for (int k = 0; k < 2; k++) {
		struct rb_joint_def def = jointed_def(RB_JOINT_HINGE, k, k - 1);

		lab_box(&lab, (rb_vec3){1, 0.1, 0.05}, 1, (rb_vec3){k + 0.5, 0, 0},
		        rb_quat_identity);
		def.at = (rb_vec3){k, 0, 0};
		def.axis = (rb_vec3){0, 1, 0};
		jointed_add(&lab, def);
	}
	lab_seal(&lab, 1);
	for (int frame = 0; frame < 1200; frame++) {
		struct rb_frame_numbers numbers;

		rb_numbers_measure(lab.world, &numbers);
		const double energy = numbers.kinetic_energy + numbers.potential_energy;
		double *const to = &worst[frame >= 600];

		begin = frame == 0 ? energy : begin;
		*to = fmax(*to, fabs(energy - begin));
		lab_step(&lab);
	}
	print_message("%g, then %g J\n", worst[0], worst[1]);
	assert_true(worst[0] > 0 && worst[1] < 4 * worst[0]);
	lab_close(&lab);
}

/* A chain that swings through the table: rows take over where it touches, and energy is lost. */
static void a_mechanism_that_begins_to_touch_gains_no_energy(void **state)
{
	struct rb_frame_numbers numbers;
	bool swung = false, rowed = false;
	double begin = 0;
	struct lab lab;

	(void)state;
	lab_open(&lab, 3, 400);
	lab_surface(&lab, 0.3, 0.5);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 1.0 / 400;
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	for (int k = 0; k < 3; k++) {
		struct rb_joint_def def = jointed_def(RB_JOINT_BALL, k, k - 1);

		lab_box(&lab, (rb_vec3){0.5, 0.1, 0.1}, 1, (rb_vec3){0.5 * k + 0.25, 0.02 * k, 0},
		        rb_quat_identity);
		def.at = (rb_vec3){0.5 * k, 0.02 * k, 0};
		jointed_add(&lab, def);
	}
	lab_plane(&lab, (rb_vec3){0, 0, -1.2}, (rb_vec3){0, 0, 1});
	lab_seal(&lab, 1);
	for (int frame = 0; frame < 1200; frame++) {
		lab_step(&lab);
		rb_numbers_measure(lab.world, &numbers);
		const bool swings = lab.world->stepped->solver.joint[0].reduced;
		const double energy = numbers.kinetic_energy + numbers.potential_energy;

		begin = frame == 0 ? energy : begin;
		swung = swung || swings;
		rowed = rowed || !swings;
		/* J; 15 is what it weighs by its length */
		assert_true(energy <= begin + 1e-4);
	}
	assert_true(swung && rowed);
	lab_close(&lab);
}

/*
 * Two links, or one, that swing past a table by less than a step takes them; on it bounce two balls
 * that are joined.
 */
static void open_passing(struct lab *lab, int links, bool table)
{
	lab_open(lab, 4, 60);
	lab_surface(lab, 0.3, 0.9);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.time_step_s = 1.0 / 60;
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab->scene.record.ledger = lab->scene.record.ledger_given = true;
	for (int k = 0; k < links; k++) {
		struct rb_joint_def def = jointed_def(RB_JOINT_HINGE, k, k - 1);

		lab_box(lab, (rb_vec3){0.98, 0.1, 0.05}, 1, (rb_vec3){k + 0.5, 0, 0},
		        rb_quat_identity);
		def.at = (rb_vec3){k, 0, 0};
		def.axis = (rb_vec3){0, 1, 0};
		jointed_add(lab, def);
	}
	for (int k = 0; k < 2 && table; k++)
		lab_sphere(lab, 0.05, 1, (rb_vec3){9 + 0.2 * k, 0, 0.3 - links},
		           (rb_vec3){0, 0, 0});
	if (table) {
		struct rb_joint_def def = jointed_def(RB_JOINT_BALL, links, links + 1);

		def.at = (rb_vec3){9.1, 0, 0.3 - links};
		jointed_add(lab, def);
		lab_plane(lab, (rb_vec3){0, 0, -links - 1e-3}, (rb_vec3){0, 0, 1});
	}
	lab_seal(lab, 1);
}

static void what_a_mechanism_only_comes_near_does_not_change_its_way(void **state)
{
	(void)state;
	for (int links = 1; links <= 2; links++) {
		struct lab lab, free;
		size_t near = 0;

		open_passing(&lab, links, true);
		open_passing(&free, links, false);
		while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world)) {
			lab_step(&lab);
			lab_step(&free);
			for (size_t k = 0; k < lab.world->stepped->all.points.count; k++)
				near += lab.world->stepped->all.points.row[k].a < links;
			assert_true(lab.world->stepped->solver.joint[0].reduced);
			for (int k = 0; k < links; k++)
				assert_memory_equal(lab.world->state.position + 3 * k,
				                    free.world->state.position + 3 * k,
				                    3 * sizeof(double));
		}
		print_message("%zu points\n", near);
		assert_true(near > 0);
		lab_close(&free);
		lab_close(&lab);
	}
}

/* Two bars that hang from the world, in one island by a rope that is slack. */
static void each_support_is_entered_once(void **state)
{
	struct rb_joint_def rope = jointed_def(RB_JOINT_ROPE, 0, 1);
	rb_vec3 momentum[2][2];
	double energy[2];
	struct lab lab;

	(void)state;
	lab_open(&lab, 0.2, 100);
	lab.scene.world.method = RB_METHOD_STEPPED;
	lab.scene.world.time_step_s = 1e-3;
	lab.scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab.scene.record.ledger = lab.scene.record.ledger_given = true;
	for (int k = 0; k < 2; k++) {
		struct rb_joint_def def = jointed_def(RB_JOINT_HINGE, k, WORLD);

		lab_box(&lab, (rb_vec3){1, 0.1, 0.1}, 1 + k, (rb_vec3){0.5, 3 * k, 0},
		        rb_quat_identity);
		def.at = (rb_vec3){0, 3 * k, 0};
		def.axis = (rb_vec3){0, 1, 0};
		jointed_add(&lab, def);
	}
	rope.length_m = 5;
	jointed_add(&lab, rope);
	lab_seal(&lab, 1);
	measure(&lab, &energy[0], momentum[0]);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world))
		lab_step(&lab);
	measure(&lab, &energy[1], momentum[1]);
	assert_true(lab.world->stepped->solver.joint[0].reduced);
	for (int r = 0; r < 2; r++)
		assert_vector(momentum[1][r], momentum[0][r], 1e-12);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_kind_of_joint_moves_in_steps_as_it_is_located),
		cmocka_unit_test(swinging_is_of_order_six),
		cmocka_unit_test(a_light_link_that_whips_round_is_followed_in_parts),
		cmocka_unit_test(energy_does_not_drift),
		cmocka_unit_test(a_mechanism_that_begins_to_touch_gains_no_energy),
		cmocka_unit_test(what_a_mechanism_only_comes_near_does_not_change_its_way),
		cmocka_unit_test(each_support_is_entered_once),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
