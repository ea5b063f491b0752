/* SPDX-License-Identifier: MIT */
/* Joints by the located method: pendulums, mechanisms, impacts through joints. */
#include "jointed.h"

#include <float.h>

#include "base/memory.h"
#include "method/numbers.h"
#include "model/joints.h"

static const double gravity = 9.81;

static void open(struct lab *lab, double duration, double frame_rate)
{
	lab_open_located(lab, duration, frame_rate);
	lab->scene.world.gravity = (rb_vec3){0, 0, -gravity};
}

static void to_end(struct lab *lab)
{
	while (lab->world->state.frame + 1 < lab->model->frame_count)
		if (rb_world_step_frame(lab->world, &lab->error) != RB_OK)
			fail_msg("%s", lab->error.text);
}

static rb_vec3 place(const struct lab *lab, int i)
{
	return rb_vec3_from(lab->world->state.position + 3 * i);
}

/* Two masses of 1 kg on rods of 1 m, from the horizontal: by two programs of 30 digits. */
static void a_double_pendulum_is_where_it_should_be(void **state)
{
	struct lab lab;

	(void)state;
	open(&lab, 10, 0.2);
	lab_sphere(&lab, 0.1, 1, (rb_vec3){1, 0, 0}, (rb_vec3){0, 0, 0});
	lab_sphere(&lab, 0.1, 1, (rb_vec3){2, 0, 0}, (rb_vec3){0, 0, 0});
	struct rb_joint_def def = jointed_def(RB_JOINT_ROD, 0, -1);

	def.at_b = (rb_vec3){0, 0, 0};
	jointed_add(&lab, def);
	jointed_add(&lab, jointed_def(RB_JOINT_ROD, 0, 1));
	lab_seal(&lab, 1);
	assert_int_equal(rb_world_step_frame(lab.world, &lab.error), RB_OK);
	print_message("at 5 s: %.3g %.3g %.3g %.3g\n", place(&lab, 0).x + 0.58686920981627,
	              place(&lab, 0).z + 0.80968174647180, place(&lab, 1).x + 1.55077846947044,
	              place(&lab, 1).z + 1.07591273481265);
	assert_near(place(&lab, 0).x, -0.58686920981627, 1e-11);
	assert_near(place(&lab, 0).z, -0.80968174647180, 1e-11);
	assert_near(place(&lab, 1).x, -1.55077846947044, 1e-11);
	assert_near(place(&lab, 1).z, -1.07591273481265, 1e-11);
	to_end(&lab);
	assert_near(place(&lab, 0).x, -0.538347239612, 1e-9);
	assert_near(place(&lab, 0).z, -0.842723115621, 1e-9);
	assert_near(place(&lab, 1).x, -1.040765783246, 1e-9);
	assert_near(place(&lab, 1).z, -1.707347662469, 1e-9);
	lab_close(&lab);
}

/* Largest error of any joint's rows, m or rad. */
static double drift(const struct lab *lab)
{
	const struct rb_joints *joints = lab->model->joints;
	double max = 0;

	for (int k = 0; k < joints->count; k++) {
		struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
		struct rb_pose end[2];
		const int body[2] = {joints->joint[k].a, joints->joint[k].b};

		for (int e = 0; e < 2; e++) {
			end[e] = rb_linkage_world();
			if (body[e] < 0)
				continue;
			end[e].position = lab->model->position[body[e]];
			end[e].orientation = lab->model->orientation[body[e]];
			if (body[e] >= lab->model->body_count)
				continue;
			end[e].position = place(lab, body[e]);
			end[e].orientation = lab->world->state.orientation
			                             ? rb_quat_from(lab->world->state.orientation +
			                                            4 * body[e])
			                             : lab->model->orientation[body[e]];
		}
		const int count = rb_linkage_rows(&joints->joint[k].link, &end[0], &end[1], row);

		for (int r = 0; r < count; r++)
			max = fmax(max, fabs(row[r].error));
	}
	return max;
}

/* Nothing is unexplained beyond these shares, and joints are closed. */
static void balances(struct lab *lab, double energy, double momentum, double open_m)
{
	struct rb_frame_numbers numbers = {0};

	rb_numbers_measure(lab->world, &numbers);
	assert_true(numbers.has_ledger);
	const struct rb_ledger_values *l = &numbers.ledger;
	const double unexplained = fabs(l->energy[RB_ENERGY_CAUSES]) /
	                           fmax(l->energy_scale, gravity); /* of 1 kg by 1 m */
	/* of what only turns all momentum is rounding: of a millionth of its angular momentum by 1 m */
	const double linear = rb_vec3_length(l->momentum[RB_MOMENTUM_CAUSES][0]) /
	                      fmax(fmax(l->momentum_scale[0], 1e-6 * l->momentum_scale[1]),
	                           DBL_MIN);
	const double angular = rb_vec3_length(l->momentum[RB_MOMENTUM_CAUSES][1]) /
	                       fmax(l->momentum_scale[1], DBL_MIN);

	print_message("unexplained %.2g, %.2g, %.2g; drift %.2g m\n", unexplained, linear, angular,
	              drift(lab));
	assert_near(unexplained, 0, energy);
	assert_near(linear, 0, momentum);
	assert_near(angular, 0, momentum);
	assert_near(drift(lab), 0, open_m);
}

/* From the horizontal it is back after 2.36784194757623745 s for each metre, at rest. */
static void a_simple_pendulum_keeps_its_period(void **state)
{
	const double period = 2.36784194757623745;

	(void)state;
	for (int kind = 0; kind < 2; kind++) {
		struct lab lab;

		open(&lab, 10 * period, 1 / period);
		lab_sphere(&lab, 1e-3, 1, (rb_vec3){1, 0, 0}, (rb_vec3){0, 0, 0});
		const rb_mat3 moments = rb_mat3_diagonal(1e-13, 1e-13, 1e-13);
		lab.scene.bodies[0].inertia = &moments;
		struct rb_joint_def def = jointed_def(kind ? RB_JOINT_HINGE : RB_JOINT_ROD, 0, -1);

		def.at_b = (rb_vec3){0, 0, 0};
		def.axis = (rb_vec3){0, 1, 0};
		jointed_add(&lab, def);
		lab_seal(&lab, 1);
		to_end(&lab);
		print_message("%.3g %.3g\n", place(&lab, 0).x - 1, place(&lab, 0).z);
		assert_near(place(&lab, 0).x, 1, 1e-13);
		assert_near(place(&lab, 0).z, 0, 1e-12);
		/* which makes it slower by half of that, in ten periods, g of that */
		assert_near(lab.world->state.velocity[2], kind ? 1.2e-11 : 0, 1e-12);
		balances(&lab, 1e-13, 1e-12, 1e-14);
		lab_close(&lab);
	}
}

static struct rb_body_def brick(rb_vec3 position, int k)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "box";
	def.shape.kind = RB_SHAPE_BOX;
	def.shape.size[0] = 0.6;
	def.shape.size[1] = 0.2;
	def.shape.size[2] = 0.1;
	def.mass = 1 + 0.5 * k;
	def.position = position;
	def.orientation = rb_quat_from_turn((rb_vec3){0.3 * k, 0.2, -0.1 * k});
	return def;
}

/* Three bricks, the first on a ball joint at the world, the others by joints of each kind. */
static void every_kind_keeps_energy_and_momentum(void **state)
{
	(void)state;
	for (int kind = 0; kind <= RB_JOINT_ROD; kind++) {
		struct lab lab;

		open(&lab, 3, 10);
		for (int k = 0; k < 3; k++) {
			const struct rb_body_def def = brick((rb_vec3){0.9 * k, 0.1 * k, 0.05}, k);

			lab_add(&lab, &def);
		}
		struct rb_joint_def def = jointed_def(RB_JOINT_BALL, 0, -1);

		def.at = (rb_vec3){-0.45, 0, 0};
		jointed_add(&lab, def);
		for (int k = 0; k < 2; k++) {
			def = jointed_def(kind, k + 1, k);
			def.at = (rb_vec3){0.9 * k + 0.45, 0.1, 0.02};
			def.axis = (rb_vec3){0.3, 1, 0.2 * k};
			def.axis_b = (rb_vec3){-1, 0.3, 0};
			if (kind == RB_JOINT_ROD) {
				def.at_a = (rb_vec3){-0.1, 0.05, 0};
				def.at_b = (rb_vec3){0.3, 0.1, 0.05};
				def.at.x = (double)NAN;
			}
			jointed_add(&lab, def);
		}
		lab_seal(&lab, 1);
		to_end(&lab);
		print_message("%s: ", rb_joint_kind_name(kind));
		balances(&lab, 1e-12, 1e-12, 1e-13);
		lab_close(&lab);
	}
}

static struct rb_body_def bar(rb_vec3 position, rb_vec3 size, double mass)
{
	return lab_box_def(size, mass, position);
}

static double energy(const struct lab *lab)
{
	struct rb_frame_numbers numbers = {0};

	rb_numbers_measure(lab->world, &numbers);
	return numbers.kinetic_energy + numbers.potential_energy;
}

/*
 * A ball falls on one of two hinged bars, at a from its middle. With H the impulse of the hinge on
 * the second bar and P that of the ball, all along z: v1 + t1 L / 2 = v2 - t2 L / 2 gives H / P.
 */
static void an_impact_goes_through_a_hinge(void **state)
{
	const double length = 1, mass = 2, ball = 0.7, a = 0.4, speed = 3;
	const double inertia = mass * (length * length + 0.04) / 12;
	const double end = 1 / mass + length * length / (4 * inertia);
	const double hinge = -(1 / mass - a * length / (2 * inertia)) / (2 * end);
	const double bars = (1 + hinge) / mass + a * (a - 0.5 * length * hinge) / inertia;

	(void)state;
	for (int e = 1; e <= 2; e++) { /* 0: it goes on pressing */
		struct lab lab;
		const double restitution = 0.5 * e;
		const double impulse = (1 + restitution) * speed / (bars + 1 / ball);

		lab_open_located(&lab, 1, 10);
		lab_surface(&lab, 0, restitution);
		struct rb_body_def def = bar((rb_vec3){0, 0, 0}, (rb_vec3){1, 0.2, 0.2}, mass);
		lab_add(&lab, &def);
		def.position.x = 1;
		lab_add(&lab, &def);
		lab_sphere(&lab, 0.1, ball, (rb_vec3){1 + a, 0, 0.3}, (rb_vec3){0, 0, -speed});
		struct rb_joint_def hinged = jointed_def(RB_JOINT_HINGE, 0, 1);
		hinged.at = (rb_vec3){0.5, 0, 0};
		hinged.axis = (rb_vec3){0, 1, 0};
		jointed_add(&lab, hinged);
		lab_seal(&lab, 1);
		const double before = energy(&lab);

		to_end(&lab);
		assert_near(lab.world->state.velocity[8], -speed + impulse / ball, 1e-13);
		assert_near(energy(&lab) - before, -0.5 * impulse * speed * (1 - restitution),
		            1e-13);
		balances(&lab, 1e-13, 1e-13, 1e-14);
		lab_close(&lab);
	}
}

/* Beads with friction: energy only falls, and joints stay closed. */
static void beads_on_rods_fall_on_a_table(void **state)
{
	struct lab lab;

	(void)state;
	open(&lab, 1.5, 30);
	lab_surface(&lab, 0.4, 0.3);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	for (int k = 0; k < 4; k++)
		lab_sphere(&lab, 0.05, 0.5 + 0.1 * k,
		           (rb_vec3){0.05 * k, 0.02 * k * k, 0.1 + 0.2 * k}, (rb_vec3){0, 0, 0});
	for (int k = 0; k < 3; k++)
		jointed_add(&lab,
		            jointed_def(k == 1 ? RB_JOINT_FIXED : RB_JOINT_ROD, k + 1, k + 2));
	lab_seal(&lab, 1);
	double last = energy(&lab);
	while (lab.world->state.frame + 1 < lab.model->frame_count) {
		if (rb_world_step_frame(lab.world, &lab.error) != RB_OK)
			fail_msg("%s", lab.error.text);
		const double now = energy(&lab);

		assert_true(now <= last + 1e-12);
		last = now;
	}
	assert_true(last < 2.8); /* they lie: m g r */
	balances(&lab, 1e-12, 1e-12, 1e-13);
	lab_close(&lab);
}

/* A top on four legs, fixed to it, stands and sleeps: it is not moved by rounding. */
static void a_table_of_jointed_legs_stands(void **state)
{
	struct lab lab;

	(void)state;
	open(&lab, 10, 1);
	lab_surface(&lab, 0.5, 0);
	lab_plane(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	struct rb_body_def def = bar((rb_vec3){0, 0, 0.75}, (rb_vec3){1, 1, 0.1}, 5);

	lab_add(&lab, &def);
	for (int k = 0; k < 4; k++) {
		const rb_vec3 foot = {k % 2 ? 0.4 : -0.4, k / 2 ? 0.4 : -0.4, 0.35};

		def = bar(foot, (rb_vec3){0.1, 0.1, 0.7}, 1);
		lab_add(&lab, &def);
	}
	for (int k = 0; k < 4; k++) {
		struct rb_joint_def fixed = jointed_def(RB_JOINT_FIXED, 1, 2 + k);

		fixed.at = (rb_vec3){k % 2 ? 0.4 : -0.4, k / 2 ? 0.4 : -0.4, 0.7};
		jointed_add(&lab, fixed);
	}
	lab_seal(&lab, 1);
	to_end(&lab);
	for (int k = 0; k < 15; k++)
		assert_near(lab.world->state.velocity[k], 0, 0);
	assert_near(place(&lab, 0).z, 0.75, 0);
	lab_close(&lab);
}

static struct rb_joint_reading read_joint(struct lab *lab, int k)
{
	struct rb_joint_reading reading;

	if (rb_world_joint(lab->world, k, &reading, &lab->error) != RB_OK)
		fail_msg("%s", lab->error.text);
	return reading;
}

/* A wheel on a hinge counts its turns; the hinge carries its weight on the world. */
static void a_hinge_counts_turns_and_carries_weight(void **state)
{
	struct lab lab;

	(void)state;
	open(&lab, 5, 2);
	struct rb_body_def def = bar((rb_vec3){0, 0, 0}, (rb_vec3){1, 0.2, 0.5}, 2);
	def.angular_velocity = (rb_vec3){0, 10, 0};
	lab_add(&lab, &def);
	struct rb_joint_def hinged = jointed_def(RB_JOINT_HINGE, 0, -1);
	hinged.at = (rb_vec3){0, 0.3, 0};
	hinged.axis = (rb_vec3){0, -2, 0};
	jointed_add(&lab, hinged);
	lab_seal(&lab, 1);
	struct rb_joint_reading r = read_joint(&lab, 0);
	assert_near(r.angle, 0, 0);
	assert_near(r.speed, 10, 1e-14);
	to_end(&lab);
	r = read_joint(&lab, 0);
	assert_near(r.angle, 50, 1e-12);
	assert_near(r.speed, 10, 1e-13);
	/* at 0.3 m from the middle */
	assert_near(rb_vec3_length(rb_vec3_sub(r.force, (rb_vec3){0, 0, -2 * gravity})), 0, 1e-12);
	assert_near(r.torque.x, 2 * gravity * 0.3, 1e-12);
	struct rb_load load;
	assert_int_equal(rb_world_load(lab.world, 0, &load, &lab.error), RB_OK);
	assert_near(rb_vec3_length(load.force), 0, 1e-12);
	assert_near(rb_vec3_length(load.torque), 0, 1e-12);
	lab_close(&lab);
}

/* Lowest after the half of a swing: the rod pulls with three times the weight. */
static void a_rod_pulls(void **state)
{
	const double lowest = 2.36784194757623745 / 4;
	struct lab lab;

	(void)state;
	open(&lab, lowest, 1 / lowest);
	lab_sphere(&lab, 0.1, 2, (rb_vec3){1, 0, 0}, (rb_vec3){0, 0, 0});
	struct rb_joint_def def = jointed_def(RB_JOINT_ROD, 0, -1);
	def.at_b = (rb_vec3){0, 0, 0};
	jointed_add(&lab, def);
	lab_seal(&lab, 1);
	assert_near(rb_vec3_length(read_joint(&lab, 0).force), 0, 1e-14);
	to_end(&lab);
	const struct rb_joint_reading r = read_joint(&lab, 0);
	assert_near(r.force.z, -6 * gravity, 1e-12);
	assert_near(r.force.x, 0, 1e-12);
	assert_near(r.angle, 1, 1e-14); /* the distance of its ends */
	assert_near(r.speed, 0, 1e-13);
	lab_close(&lab);
}

/* A cantilever of two fixed bars: what each carries at its root. */
static void fixed_joints_carry_moments(void **state)
{
	struct lab lab;

	(void)state;
	open(&lab, 1, 1);
	struct rb_body_def def = bar((rb_vec3){0.5, 0, 0}, (rb_vec3){1, 0.1, 0.1}, 2);
	lab_add(&lab, &def);
	def.position.x = 1.5;
	lab_add(&lab, &def);
	for (int k = 0; k < 2; k++) {
		struct rb_joint_def fixed = jointed_def(RB_JOINT_FIXED, k, k - 1);

		fixed.at = (rb_vec3){k, 0, 0};
		jointed_add(&lab, fixed);
	}
	lab_seal(&lab, 1);
	to_end(&lab);
	assert_near(read_joint(&lab, 0).torque.y, 2 * gravity * 2, 1e-12);
	assert_near(read_joint(&lab, 1).torque.y, 2 * gravity * 0.5, 1e-12);
	assert_near(read_joint(&lab, 1).force.z, -2 * gravity, 1e-12);
	assert_near(rb_vec3_length(rb_vec3_from(lab.world->state.velocity + 3)), 0, 0);
	lab_close(&lab);
}

/* A wheel that a torsion spring turns several times, with a damper: q'' + 2 d q' + w^2 q = 0. */
static void a_torsion_spring_turns_a_wheel(void **state)
{
	const double inertia = 2 * (1 + 0.25) / 12, rest = 20, stiffness = 3 * inertia;
	const double damping = 0.2 * inertia, d = 0.1, w = sqrt(3 - d * d), t = 4;
	struct lab lab;

	(void)state;
	lab_open_located(&lab, t, 1);
	const struct rb_body_def def = bar((rb_vec3){0, 0, 0}, (rb_vec3){1, 0.2, 0.5}, 2);
	lab_add(&lab, &def);
	struct rb_joint_def hinged = jointed_def(RB_JOINT_HINGE, 0, -1);
	hinged.at = (rb_vec3){0, 0.3, 0};
	hinged.axis = (rb_vec3){0, 1, 0};
	hinged.stiffness = stiffness;
	hinged.damping = damping;
	hinged.rest = rest;
	jointed_add(&lab, hinged);
	lab_seal(&lab, 1);
	const double start = energy(&lab);

	assert_near(start, 0.5 * stiffness * rest * rest, 1e-12);
	to_end(&lab);
	const struct rb_joint_reading r = read_joint(&lab, 0);
	const double envelope = -rest * exp(-d * t);

	assert_near(r.angle, rest + envelope * (cos(w * t) + d / w * sin(w * t)), 1e-11);
	assert_near(r.speed, -envelope * (w + d * d / w) * sin(w * t), 1e-11);
	assert_near(r.torque.y, -stiffness * (r.angle - rest) - damping * r.speed, 1e-12);
	balances(&lab, 1e-13, 1e-13, 1e-14);
	lab_close(&lab);
}

/* Two carts on one line, held together by the spring of a slider between them. */
static void a_slider_has_a_spring(void **state)
{
	struct lab lab;

	(void)state;
	lab_open_located(&lab, 2, 1);
	for (int k = 0; k < 2; k++) {
		struct rb_body_def def = bar((rb_vec3){k, 0, 0}, (rb_vec3){0.5, 0.2, 0.1}, 1 + k);

		def.velocity = (rb_vec3){k ? 1 : -2, 0, 0};
		lab_add(&lab, &def);
	}
	struct rb_joint_def def = jointed_def(RB_JOINT_SLIDER, 0, 1);
	def.at = (rb_vec3){0.5, 0, 0};
	def.axis = (rb_vec3){1, 0, 0};
	def.stiffness = 6;
	jointed_add(&lab, def);
	lab_seal(&lab, 1);
	to_end(&lab);
	const double w = 3; /* of 6 N/m and 2/3 kg */
	const struct rb_joint_reading r = read_joint(&lab, 0);

	assert_near(r.angle, sin(w * 2), 1e-12);
	assert_near(r.speed, w * cos(w * 2), 1e-12);
	assert_near(r.force.x, -6 * r.angle, 1e-12);
	balances(&lab, 1e-13, 1e-13, 1e-14);
	lab_close(&lab);
}

/* The end of a rod is shaken: z = 0.1 sin 7 t, and back; all that it does is in the ledger. */
static enum rb_status shake(void *user, int id, double t, struct rb_driven_pose *pose,
                            struct rb_error *err)
{
	const rb_vec3 none = {0, 0, 0};

	(void)user, (void)id, (void)err;
	pose->position = (rb_vec3){0.05 * sin(5 * t), 0, 0.1 * sin(7 * t)};
	pose->velocity = (rb_vec3){0.25 * cos(5 * t), 0, 0.7 * cos(7 * t)};
	pose->angular_velocity = none;
	pose->has_velocity = pose->has_angular_velocity = true;
	return RB_OK;
}

static void a_driven_end_does_what_the_ledger_says(void **state)
{
	const struct rb_world_options options = {.threads = 1};
	const struct rb_world_hooks hooks = {.motion = shake};

	(void)state;
	for (int kind = RB_JOINT_FIXED; kind <= RB_JOINT_ROD; kind++) {
		struct lab lab;

		open(&lab, 2, 10);
		struct rb_body_def def = lab_sphere_def(0.1, 1, (rb_vec3){0, 0, 0},
		                                        (rb_vec3){0.25, 0, 0.7});
		def.motion = 0;
		def.motion_gives_velocity = def.motion_gives_angular_velocity = true;
		def.mass = (double)NAN;
		lab_add(&lab, &def);
		def = bar((rb_vec3){0.5, 0.1, 0}, (rb_vec3){0.5, 0.2, 0.1}, 1);
		def.velocity = (rb_vec3){0.25, 0, 0.7};
		lab_add(&lab, &def);
		struct rb_joint_def held = jointed_def(kind, kind % 2, 1 - kind % 2);
		held.at = (rb_vec3){0.2, 0.05, 0};
		held.axis = (rb_vec3){0, 1, 0.3};
		held.axis_b = (rb_vec3){1, 0, 0};
		if (kind == RB_JOINT_ROD)
			held.at.x = (double)NAN;
		jointed_add(&lab, held);
		lab_seal_with(&lab, &options, &hooks);
		to_end(&lab);
		print_message("%s: ", rb_joint_kind_name(kind));
		balances(&lab, 1e-12, 1e-12, 1e-13);
		lab_close(&lab);
	}
}

static struct rb_joint_def wheel(struct lab *lab, double duration, double spin)
{
	struct rb_body_def def = bar((rb_vec3){0, 0, 0}, (rb_vec3){1, 0.2, 0.5}, 2.4);
	struct rb_joint_def hinged = jointed_def(RB_JOINT_HINGE, -1, 0);

	lab_open_located(lab, duration, 1 / duration);
	def.angular_velocity = (rb_vec3){0, spin, 0};
	lab_add(lab, &def);
	hinged.a = 0;
	hinged.b = -1;
	hinged.at = (rb_vec3){0, 0, 0};
	hinged.axis = (rb_vec3){0, -1,
	                        0}; /* of the world against the wheel: the wheel's own turn */
	return hinged;
}

/* I = 0.25 kg m^2: it comes to 10 rad/s after I w / tau = 1.25 s, having turned by 6.25 rad. */
static void a_motor_brings_a_wheel_to_its_speed(void **state)
{
	(void)state;
	for (int sign = -1; sign <= 1; sign += 2) {
		struct lab lab;
		struct rb_joint_def def = wheel(&lab, 2, 0);

		def.motor_speed = 10 * sign;
		def.motor_max = 2;
		jointed_add(&lab, def);
		lab_seal(&lab, 1);
		to_end(&lab);
		const struct rb_joint_reading r = read_joint(&lab, 0);

		assert_near(r.speed, 10 * sign, 1e-13);
		assert_near(r.angle, sign * (6.25 + 10 * 0.75), 1e-12);
		balances(&lab, 1e-13, 1e-13, 1e-14);
		struct rb_frame_numbers numbers = {0};
		rb_numbers_measure(lab.world, &numbers);
		assert_near(numbers.ledger.energy[RB_ENERGY_DRIVEN], 0.5 * 0.25 * 100, 1e-12);
		lab_close(&lab);
	}
}

/* ... and friction of 0.5 N m stops it after I w / tau = 2 s and 4 rad, for good. */
static void friction_stops_a_hinge(void **state)
{
	struct lab lab;
	struct rb_joint_def def = wheel(&lab, 5, 4);

	(void)state;
	def.friction = 0.5;
	jointed_add(&lab, def);
	lab_seal(&lab, 1);
	to_end(&lab);
	const struct rb_joint_reading r = read_joint(&lab, 0);

	assert_near(r.speed, 0, 1e-30);
	assert_near(r.angle, 4, 1e-12);
	struct rb_frame_numbers numbers = {0};
	rb_numbers_measure(lab.world, &numbers);
	assert_near(numbers.ledger.energy[RB_ENERGY_JOINT_FRICTION], 0.5 * 0.25 * 16, 1e-12);
	lab_close(&lab);
}

/* A motor against friction, and a load that is too much for it: it is drawn back. */
static void a_motor_lifts_what_it_can(void **state)
{
	(void)state;
	for (int heavy = 0; heavy < 2; heavy++) {
		struct lab lab;
		const double mass = heavy ? 3 : 1;

		open(&lab, 2, 1);
		struct rb_body_def cart = bar((rb_vec3){0, 0, 0}, (rb_vec3){0.1, 0.1, 0.1}, mass);
		lab_add(&lab, &cart);
		cart.position = (rb_vec3){3, 0, 0};
		cart.is_static = true;
		lab_add(&lab, &cart);
		struct rb_joint_def def = jointed_def(RB_JOINT_SLIDER, 1, 0);
		def.at = (rb_vec3){0, 0, 0};
		def.axis = (rb_vec3){0, 0, 1};
		def.motor_speed = 0.5;
		def.motor_max = 25;
		def.friction = 2;
		jointed_add(&lab, def);
		lab_seal(&lab, 1);
		to_end(&lab);
		const struct rb_joint_reading r = read_joint(&lab, 0);
		/* with 25 N less the friction of 2 N; or 25 N and the friction against the fall */
		const double a = heavy ? (25 + 2 - mass * gravity) / mass
		                       : (25 - 2 - mass * gravity) / mass;

		assert_near(r.speed, heavy ? a * 2 : 0.5, 1e-12);
		assert_near(r.angle, heavy ? a * 2 : 0.5 * 2 - 0.5 * 0.5 * 0.5 / a, 1e-12);
		assert_near(r.force.z, heavy ? 27 : mass * gravity, 1e-11);
		balances(&lab, 1e-13, 1e-13, 1e-14);
		lab_close(&lab);
	}
}

/* A pendulum with friction swings until it sticks, aslant: no force moves it any more. */
static void friction_holds_a_pendulum(void **state)
{
	struct lab lab;

	(void)state;
	open(&lab, 30, 1);
	const struct rb_body_def def = bar((rb_vec3){0.5, 0, 0}, (rb_vec3){1, 0.1, 0.1}, 1);
	lab_add(&lab, &def);
	struct rb_joint_def hinged = jointed_def(RB_JOINT_HINGE, 0, -1);
	hinged.at = (rb_vec3){0, 0, 0};
	hinged.axis = (rb_vec3){0, 1, 0};
	hinged.friction = 0.7;
	jointed_add(&lab, hinged);
	lab_seal(&lab, 1);
	to_end(&lab);
	const struct rb_joint_reading r = read_joint(&lab, 0);

	assert_near(r.speed, 0, 0);
	assert_true(fabs(place(&lab, 0).x) * gravity < 0.7);
	balances(&lab, 1e-12, 1e-12, 1e-13);
	lab_close(&lab);
}

/* Four balls in a line, joined to each other, and at both ends to the world, taut. */
static void open_taut(struct lab *lab, enum rb_joint_kind kind, rb_vec3 g, rb_vec3 velocity)
{
	enum { BALLS = 4 };

	open(lab, 1, 10);
	lab->scene.world.gravity = g;
	for (int k = 0; k < BALLS; k++)
		lab_sphere(lab, 0.05, 1, (rb_vec3){k, 0, 0},
		           k == 1 ? velocity : (rb_vec3){0, 0, 0});
	for (int k = 0; k <= BALLS; k++) {
		struct rb_joint_def def = jointed_def((int)kind, k < BALLS ? k : BALLS - 1,
		                                      k > 0 && k < BALLS ? k - 1 : -1);

		if (kind == RB_JOINT_BALL)
			def.at = (rb_vec3){k - 0.5, 0, 0};
		else if (k == 0 || k == BALLS)
			def.at_b = (rb_vec3){k == 0 ? -1 : k, 0, 0};
		jointed_add(lab, def);
	}
	lab_seal(lab, 1);
}

/* Runs it until it fails with these words. */
static void fails_with(struct lab *lab, const char *first, const char *second)
{
	enum rb_status status = RB_OK;

	while (status == RB_OK && lab->world->state.frame + 1 < lab->model->frame_count)
		status = rb_world_step_frame(lab->world, &lab->error);
	print_message("%s\n", lab->error.text);
	assert_int_equal(status, RB_ERR_PHYSICS);
	assert_non_null(strstr(lab->error.text, first));
	assert_non_null(strstr(lab->error.text, second));
	lab_close(lab);
}

/* What is free to first order is not to second: no motion keeps these joints. */
static void a_taut_chain_fails_by_name(void **state)
{
	const rb_vec3 none = {0, 0, 0}, across = {0, 0, -gravity}, along = {-gravity, 0, 0};

	(void)state;
	for (int kind = 0; kind < 2; kind++) {
		const enum rb_joint_kind of = kind ? RB_JOINT_BALL : RB_JOINT_ROD;
		const char *const name = kind ? "ball #4" : "rod #4";
		struct lab lab;

		/* falls across */
		open_taut(&lab, of, across, none);
		fails_with(&lab, name, "they lock");
		/* is thrown across */
		open_taut(&lab, of, none, (rb_vec3){0, 0.1, 0});
		fails_with(&lab, name, "they lock");
		/* so slowly that against its weight that is next to rounding */
		open_taut(&lab, of, along, (rb_vec3){0, 1e-3, 0});
		fails_with(&lab, "what is joined to it", "lock and let go in turn");
		/* hangs */
		open_taut(&lab, of, along, none);
		to_end(&lab);
		balances(&lab, 1e-14, 1e-14, 1e-14);
		lab_close(&lab);
	}
}

/* A wheel that spins in gimbals, all of them balanced: what they carry is rounding and weight. */
static void a_balanced_wheel_goes_on_spinning(void **state)
{
	const rb_vec3 size[3] = {{0.03, 0.5, 0.03}, {0.4, 0.03, 0.03}, {0, 0, 0}};
	const rb_vec3 axis[3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
	const double mass[3] = {3.825, 3.06, 11.5};
	struct lab lab;

	(void)state;
	open(&lab, 0.5, 60);
	for (int k = 0; k < 3; k++) {
		struct rb_body_def def = bar((rb_vec3){0, 0, 0}, size[k], mass[k]);

		def.filters = true; /* of none */
		if (k == 2) {
			def.call = "cylinder";
			def.shape.kind = RB_SHAPE_CYLINDER;
			def.shape.radius = 0.12;
			def.shape.size[2] = 0.03;
			/* by rounding not quite */
			def.orientation = rb_quat_from_turn((rb_vec3){0, acos(0), 0});
		}
		def.angular_velocity = (rb_vec3){k == 2 ? 200 : 0, 0, 0};
		lab_add(&lab, &def);
	}
	for (int k = 0; k < 3; k++) {
		struct rb_joint_def def = jointed_def(RB_JOINT_HINGE, k, k - 1);

		def.at = (rb_vec3){0, 0, 0};
		def.axis = axis[k];
		jointed_add(&lab, def);
	}
	lab_seal(&lab, 1);
	to_end(&lab);
	const rb_vec3 spin = rb_vec3_from(lab.world->state.spin + 6);

	print_message("spin %.3g %.3g %.3g\n", spin.x - 200, spin.y, spin.z);
	assert_near(spin.x, 200, 1e-11);
	assert_near(spin.y, 0, 1e-11);
	assert_near(spin.z, 0, 1e-11);
	balances(&lab, 1e-14, 1e-14, 1e-14);
	lab_close(&lab);
}

/* Rows of joints that share few bodies: no matrix of all of them is reserved, 72 MB here. */
static void a_long_chain_takes_little_memory(void **state)
{
	enum { LINKS = 1000 };
	struct lab lab;

	(void)state;
	open(&lab, 0.02, 100);
	for (int k = 0; k < LINKS; k++) {
		struct rb_joint_def def = jointed_def(RB_JOINT_BALL, k, k - 1);

		lab_sphere(&lab, 0.1, 1, (rb_vec3){k, 0, 0}, (rb_vec3){0, 0, 0});
		def.at = (rb_vec3){k - 0.5, 0, 0};
		if (k > 0)
			jointed_add(&lab, def);
	}
	lab_seal(&lab, 1);
	to_end(&lab);
	assert_true(rb_memory_counts().bytes_peak < 48000000);
	const rb_vec3 last = {LINKS - 1, 0, -0.5 * gravity * pow(lab.world->state.time_s, 2)};

	assert_vector(place(&lab, LINKS - 1), last, 1e-12);
	lab_close(&lab);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_motor_brings_a_wheel_to_its_speed),
		cmocka_unit_test(friction_stops_a_hinge),
		cmocka_unit_test(a_motor_lifts_what_it_can),
		cmocka_unit_test(friction_holds_a_pendulum),
		cmocka_unit_test(a_torsion_spring_turns_a_wheel),
		cmocka_unit_test(a_slider_has_a_spring),
		cmocka_unit_test(a_driven_end_does_what_the_ledger_says),
		cmocka_unit_test(a_hinge_counts_turns_and_carries_weight),
		cmocka_unit_test(a_rod_pulls),
		cmocka_unit_test(fixed_joints_carry_moments),
		cmocka_unit_test(an_impact_goes_through_a_hinge),
		cmocka_unit_test(a_table_of_jointed_legs_stands),
		cmocka_unit_test(beads_on_rods_fall_on_a_table),
		cmocka_unit_test(a_simple_pendulum_keeps_its_period),
		cmocka_unit_test(every_kind_keeps_energy_and_momentum),
		cmocka_unit_test(a_taut_chain_fails_by_name),
		cmocka_unit_test(a_balanced_wheel_goes_on_spinning),
		cmocka_unit_test(a_long_chain_takes_little_memory),
		cmocka_unit_test(a_double_pendulum_is_where_it_should_be),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
